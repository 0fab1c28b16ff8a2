// What all kernels for matrix units have in common; they say how many SUBGROUPS their workgroups have.
enable f16;
enable wgpu_cooperative_matrix;

const THREADS = 32u * SUBGROUPS;
// Sums on their way from the matrix units to the threads: 16 rows per subgroup, in groups of four.
const STAGE_STRIDE = 5u;
var<workgroup> stage: array<vec4<f32>, SUBGROUPS * 16u * STAGE_STRIDE>;
