//! Sixteen lanes in one AVX-512 register (features F, DQ and VL).

use crate::x86::{binary, intrinsic, x86_lanes};
use std::arch::x86_64::*;

x86_lanes! {
    lanes: 16, features: "avx512f,avx512dq,avx512vl,avx2,fma",
    number: F32x16(__m512), mask: Mask16(__mmask16), word: U32x16(__m512i),
    add: _mm512_add_ps, sub: _mm512_sub_ps, mul: _mm512_mul_ps, fma: _mm512_fmadd_ps, sqrt: _mm512_sqrt_ps,
    min: _mm512_min_ps, max: _mm512_max_ps,
    splat: _mm512_set1_ps, load: _mm512_loadu_ps, store: _mm512_storeu_ps,
    add_int: _mm512_add_epi32, xor_int: _mm512_xor_si512, and_int: _mm512_and_si512, or_int: _mm512_or_si512,
    shift_left: _mm512_sll_epi32, shift_right: _mm512_srl_epi32, splat_int: _mm512_set1_epi32,
    load_int: _mm512_loadu_si512, store_int: _mm512_storeu_si512,
    mul_even: _mm512_mul_epu32, mul_low: _mm512_mullo_epi32, high_half: _mm512_srli_epi64,
    bits_of: _mm512_castps_si512, from_bits: _mm512_castsi512_ps, to_int: _mm512_cvtps_epi32,
    from_int: _mm512_cvtepi32_ps,
    rsqrt: _mm512_rsqrt14_ps, recip: _mm512_rcp14_ps,
    neg: |a| _mm512_xor_ps(a, _mm512_set1_ps(-0.0)),
    abs: |a| _mm512_abs_ps(a),
    round: |a| _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(a),
    floor: |a| _mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(a),
    lt: |a, b| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b),
    select: |mask, a, b| _mm512_mask_blend_ps(mask, b, a),
    select_int: |mask, a, b| _mm512_mask_blend_epi32(mask, b, a),
    odd_from: |even, odd| _mm512_mask_blend_epi32(0xaaaa, even, odd),
    mask_splat: |value| if value { !0 } else { 0 },
    mask_any: |mask| mask != 0,
    mask_not: |mask| !mask,
    mask_and: _kand_mask16, mask_or: _kor_mask16,
}
