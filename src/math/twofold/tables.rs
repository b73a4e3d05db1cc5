//! Constants in two parts; tests hold them against numbers of many bits.

use super::pair::Pair;

const fn pair(high: u64, low: u64) -> Pair {
    Pair { high: f64::from_bits(high), low: f64::from_bits(low) }
}

/// π
pub(super) const PI: Pair = pair(0x4009_21fb_5444_2d18, 0x3ca1_a626_3314_5c07);
/// ln 2
pub(super) const LN_2: Pair = pair(0x3fe6_2e42_fefa_39ef, 0x3c7a_bc9e_3b39_803f);

/// sin(kπ/16), k from 0 to 31.
pub(super) static SINES: [Pair; 32] = [
    pair(0x0000_0000_0000_0000, 0x0000_0000_0000_0000),
    pair(0x3fc8_f8b8_3c69_a60b, 0xbc62_6d19_b9ff_8d82),
    pair(0x3fd8_7de2_a6ae_a963, 0xbc67_2ced_d3d5_a610),
    pair(0x3fe1_c73b_39ae_68c8, 0x3c8b_25dd_267f_6600),
    pair(0x3fe6_a09e_667f_3bcd, 0xbc8b_dd34_13b2_6456),
    pair(0x3fea_9b66_290e_a1a3, 0x3c39_f630_e8b6_dac8),
    pair(0x3fed_906b_cf32_8d46, 0x3c74_57e6_1023_1ac2),
    pair(0x3fef_6297_cff7_5cb0, 0x3c75_6217_2a36_1fd3),
    pair(0x3ff0_0000_0000_0000, 0x0000_0000_0000_0000),
    pair(0x3fef_6297_cff7_5cb0, 0x3c75_6217_2a36_1fd3),
    pair(0x3fed_906b_cf32_8d46, 0x3c74_57e6_1023_1ac2),
    pair(0x3fea_9b66_290e_a1a3, 0x3c39_f630_e8b6_dac8),
    pair(0x3fe6_a09e_667f_3bcd, 0xbc8b_dd34_13b2_6456),
    pair(0x3fe1_c73b_39ae_68c8, 0x3c8b_25dd_267f_6600),
    pair(0x3fd8_7de2_a6ae_a963, 0xbc67_2ced_d3d5_a610),
    pair(0x3fc8_f8b8_3c69_a60b, 0xbc62_6d19_b9ff_8d82),
    pair(0x0000_0000_0000_0000, 0x0000_0000_0000_0000),
    pair(0xbfc8_f8b8_3c69_a60b, 0x3c62_6d19_b9ff_8d82),
    pair(0xbfd8_7de2_a6ae_a963, 0x3c67_2ced_d3d5_a610),
    pair(0xbfe1_c73b_39ae_68c8, 0xbc8b_25dd_267f_6600),
    pair(0xbfe6_a09e_667f_3bcd, 0x3c8b_dd34_13b2_6456),
    pair(0xbfea_9b66_290e_a1a3, 0xbc39_f630_e8b6_dac8),
    pair(0xbfed_906b_cf32_8d46, 0xbc74_57e6_1023_1ac2),
    pair(0xbfef_6297_cff7_5cb0, 0xbc75_6217_2a36_1fd3),
    pair(0xbff0_0000_0000_0000, 0x0000_0000_0000_0000),
    pair(0xbfef_6297_cff7_5cb0, 0xbc75_6217_2a36_1fd3),
    pair(0xbfed_906b_cf32_8d46, 0xbc74_57e6_1023_1ac2),
    pair(0xbfea_9b66_290e_a1a3, 0xbc39_f630_e8b6_dac8),
    pair(0xbfe6_a09e_667f_3bcd, 0x3c8b_dd34_13b2_6456),
    pair(0xbfe1_c73b_39ae_68c8, 0xbc8b_25dd_267f_6600),
    pair(0xbfd8_7de2_a6ae_a963, 0x3c67_2ced_d3d5_a610),
    pair(0xbfc8_f8b8_3c69_a60b, 0x3c62_6d19_b9ff_8d82),
];

/// 1/n!, n from 0 to 20.
pub(super) static INVERSE_FACTORIALS: [Pair; 21] = [
    pair(0x3ff0_0000_0000_0000, 0x0000_0000_0000_0000),
    pair(0x3ff0_0000_0000_0000, 0x0000_0000_0000_0000),
    pair(0x3fe0_0000_0000_0000, 0x0000_0000_0000_0000),
    pair(0x3fc5_5555_5555_5555, 0x3c65_5555_5555_5555),
    pair(0x3fa5_5555_5555_5555, 0x3c45_5555_5555_5555),
    pair(0x3f81_1111_1111_1111, 0x3c01_1111_1111_1111),
    pair(0x3f56_c16c_16c1_6c17, 0xbbef_49f4_9f49_f49f),
    pair(0x3f2a_01a0_1a01_a01a, 0x3b6a_01a0_1a01_a01a),
    pair(0x3efa_01a0_1a01_a01a, 0x3b3a_01a0_1a01_a01a),
    pair(0x3ec7_1de3_a556_c734, 0xbb6c_154f_8ddc_6c00),
    pair(0x3e92_7e4f_b778_9f5c, 0x3b3c_bbc0_5b4f_a99a),
    pair(0x3e5a_e645_67f5_44e4, 0xbafc_062e_06d1_f209),
    pair(0x3e21_eed8_eff8_d898, 0xbac2_aec9_59e1_4c06),
    pair(0x3de6_1246_13a8_6d09, 0x3a8f_28e0_cc74_8ebe),
    pair(0x3da9_3974_a8c0_7c9d, 0x3a30_5d6f_8a2e_fd1f),
    pair(0x3d6a_e7f3_e733_b81f, 0x39e1_d865_6b0e_e8cb),
    pair(0x3d2a_e7f3_e733_b81f, 0x39a1_d865_6b0e_e8cb),
    pair(0x3ce9_52c7_7030_ad4a, 0x398a_c981_465d_dc6c),
    pair(0x3ca6_8278_63b9_7d97, 0x394e_ec01_221a_8b0b),
    pair(0x3c62_f49b_4681_4157, 0x38f2_650f_61db_dcb4),
    pair(0x3c1e_542b_a402_0225, 0x387e_a72b_4afe_3c2f),
];
