// For kernels that sum up their `Summand`s over workgroups of so many threads.
const WORKGROUP = 256u;

var<workgroup> shares: array<Summand, WORKGROUP>;

// The sum of what the threads of a workgroup have, always in the same order. All threads call it together.
fn workgroup_sum(local: u32, mine: Summand) -> Summand {
    // Others may still read the last sum.
    workgroupBarrier();
    shares[local] = mine;
    for (var half = WORKGROUP / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if local < half {
            shares[local] += shares[local + half];
        }
    }
    workgroupBarrier();
    return shares[0];
}
