// Sizes of a tile and what its workgroup shares: two halves of what is multiplied between two barriers.
const DEPTH = $DEPTHu;
const TILE_OUTPUTS = $TILE_OUTPUTSu;
const TILE_GROUPS = $TILE_GROUPSu;
const THREADS = $THREADSu;
const THREADS_X = $THREADS_Xu;
const THREADS_Y = $THREADS_Yu;

var<workgroup> w_tile: array<vec4<f32>, $W_TILE>;
var<workgroup> x_tile: array<vec4<f32>, $X_TILE>;