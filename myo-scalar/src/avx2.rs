//! Eight lanes in one AVX2 register, with fused multiply-add (features AVX2 and FMA).

use crate::x86::{binary, intrinsic, x86_lanes};
use std::arch::x86_64::*;

x86_lanes! {
    lanes: 8, features: "avx2,fma",
    number: F32x8(__m256), mask: Mask8(__m256), word: U32x8(__m256i),
    add: _mm256_add_ps, sub: _mm256_sub_ps, mul: _mm256_mul_ps, fma: _mm256_fmadd_ps, sqrt: _mm256_sqrt_ps,
    min: _mm256_min_ps, max: _mm256_max_ps,
    splat: _mm256_set1_ps, load: _mm256_loadu_ps, store: _mm256_storeu_ps,
    add_int: _mm256_add_epi32, xor_int: _mm256_xor_si256, and_int: _mm256_and_si256, or_int: _mm256_or_si256,
    shift_left: _mm256_sll_epi32, shift_right: _mm256_srl_epi32, splat_int: _mm256_set1_epi32,
    load_int: _mm256_loadu_si256, store_int: _mm256_storeu_si256,
    mul_even: _mm256_mul_epu32, mul_low: _mm256_mullo_epi32, high_half: _mm256_srli_epi64,
    bits_of: _mm256_castps_si256, from_bits: _mm256_castsi256_ps, to_int: _mm256_cvtps_epi32,
    from_int: _mm256_cvtepi32_ps,
    rsqrt: _mm256_rsqrt_ps, recip: _mm256_rcp_ps,
    neg: |a| _mm256_xor_ps(a, _mm256_set1_ps(-0.0)),
    abs: |a| _mm256_andnot_ps(_mm256_set1_ps(-0.0), a),
    round: |a| _mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(a),
    floor: |a| _mm256_floor_ps(a),
    lt: |a, b| _mm256_cmp_ps::<_CMP_LT_OQ>(a, b),
    select: |mask, a, b| _mm256_blendv_ps(b, a, mask),
    select_int: |mask, a, b| _mm256_castps_si256(_mm256_blendv_ps(
        _mm256_castsi256_ps(b),
        _mm256_castsi256_ps(a),
        mask,
    )),
    odd_from: |even, odd| _mm256_blend_epi32::<0xaa>(even, odd),
    mask_splat: |value| intrinsic!(_mm256_castsi256_ps(_mm256_set1_epi32(-i32::from(value)))),
    mask_any: |mask| intrinsic!(_mm256_movemask_ps(mask)) != 0,
    mask_not: |mask| intrinsic!(_mm256_xor_ps(mask, _mm256_castsi256_ps(_mm256_set1_epi32(-1)))),
    mask_and: _mm256_and_ps, mask_or: _mm256_or_ps,
}
