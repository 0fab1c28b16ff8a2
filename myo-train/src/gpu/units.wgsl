// What all kernels for matrix units have in common. `units` says how many SUBGROUPS their workgroups have.

const THREADS = 32u * SUBGROUPS;
// Sums on their way from the matrix units to the threads: 16 rows per subgroup, in groups of four.
const STAGE_STRIDE = 5u;
var<workgroup> stage: array<vec4<f32>, SUBGROUPS * 16u * STAGE_STRIDE>;
