//! Reader of MJCF, the model format of MuJoCo.
