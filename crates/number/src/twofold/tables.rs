//! Constants in two parts; tests hold them against numbers of many bits.

use super::pair::Pair;

const fn pair(high: u64, low: u64) -> Pair {
    Pair { high: f64::from_bits(high), low: f64::from_bits(low) }
}

/// π
pub(super) const PI: Pair = pair(0x4009_21fb_5444_2d18, 0x3ca1_a626_3314_5c07);
/// ln 2
pub(super) const LN_2: Pair = pair(0x3fe6_2e42_fefa_39ef, 0x3c7a_bc9e_3b39_803f);

/// sin(kπ/256), k from 0 to 511.
pub(super) static SINES: [Pair; 512] = whole_turn(&FIRST_QUARTER);

/// All sines of a turn from those of its first quarter.
const fn whole_turn(first: &[Pair; 129]) -> [Pair; 512] {
    let mut all = [pair(0, 0); 512];
    let mut k = 0;
    while k < 512 {
        let half = k % 256;
        let sine = first[if half <= 128 { half } else { 256 - half }];
        // 0 has no sign.
        all[k] = if k < 256 || half == 0 { sine } else { Pair { high: -sine.high, low: -sine.low } };
        k += 1;
    }
    all
}

/// sin(kπ/256), k from 0 to 128.
const FIRST_QUARTER: [Pair; 129] = [
    pair(0x0000_0000_0000_0000, 0x0000_0000_0000_0000),
    pair(0x3f89_21d1_fcde_c784, 0x3c29_878e_be83_6d9d),
    pair(0x3f99_2155_f7a3_667e, 0xbbfb_1d63_091a_0130),
    pair(0x3fa2_d865_7594_55cd, 0x3c26_86f6_5ba9_3ac0),
    pair(0x3fa9_1f65_f10d_d814, 0xbc29_12bd_0d56_9a90),
    pair(0x3faf_656e_79f8_20e0, 0xbc22_e1eb_e392_bffe),
    pair(0x3fb2_d520_92ce_19f6, 0xbc49_a088_a8bf_6b2c),
    pair(0x3fb5_f6d0_0a9a_a419, 0xbc4f_4022_d03f_6c9a),
    pair(0x3fb9_17a6_bc29_b42c, 0xbc3e_2718_d26e_d688),
    pair(0x3fbc_3785_c79e_c2d5, 0xbc24_f39d_f133_fb21),
    pair(0x3fbf_564e_56a9_730e, 0x3c4a_2704_729a_e56d),
    pair(0x3fc1_39f0_ceda_f577, 0xbc65_2343_4d1b_3cfa),
    pair(0x3fc2_c810_6e8e_613a, 0x3c51_3000_a89a_11e0),
    pair(0x3fc4_5576_b129_3e5a, 0xbc52_85a2_4119_f7b1),
    pair(0x3fc5_e214_448b_3fc6, 0x3c65_31ff_779d_dac6),
    pair(0x3fc7_6dd9_de50_bf31, 0x3c61_d5ee_ec50_1b2f),
    pair(0x3fc8_f8b8_3c69_a60b, 0xbc62_6d19_b9ff_8d82),
    pair(0x3fca_82a0_25b0_0451, 0xbc68_7905_ffd0_84ad),
    pair(0x3fcc_0b82_6a7e_4f63, 0xbc1a_f143_9e52_1935),
    pair(0x3fcd_934f_e545_4311, 0x3c67_5b92_2771_07ad),
    pair(0x3fcf_19f9_7b21_5f1b, 0xbc64_2dee_f11d_a2c4),
    pair(0x3fd0_4fb8_0e37_fdae, 0xbc04_12cd_b725_83cc),
    pair(0x3fd1_11d2_62b1_f677, 0x3c78_24c2_0ab7_aa9a),
    pair(0x3fd1_d344_3f4c_db3e, 0xbc67_20d4_1c13_519e),
    pair(0x3fd2_9406_2ed5_9f06, 0xbc75_d28d_a2c4_612d),
    pair(0x3fd3_5410_c2e1_8152, 0xbc73_cb00_2f96_e062),
    pair(0x3fd4_135c_9417_6601, 0x3c70_c97c_4afa_2518),
    pair(0x3fd4_d1e2_4278_e76a, 0x3c62_4172_1879_2858),
    pair(0x3fd5_8f9a_75ab_1fdd, 0xbc1e_fdc0_d58c_f620),
    pair(0x3fd6_4c7d_dd3f_27c6, 0x3c51_0d2b_4a66_4121),
    pair(0x3fd7_0885_30fa_459f, 0xbc74_4b19_e086_4c5d),
    pair(0x3fd7_c3a9_311d_cce7, 0x3c19_a3f2_1ef3_e8d9),
    pair(0x3fd8_7de2_a6ae_a963, 0xbc67_2ced_d3d5_a610),
    pair(0x3fd9_372a_63bc_93d7, 0x3c66_8431_9e5a_d5b1),
    pair(0x3fd9_ef79_43a8_ed8a, 0x3c66_da81_290b_dbab),
    pair(0x3fda_a6c8_2b6d_3fca, 0xbc7d_5f10_6ee5_ccf7),
    pair(0x3fdb_5d10_09e1_5cc0, 0x3c65_b362_cb97_4183),
    pair(0x3fdc_1249_d801_1ee7, 0xbc78_13aa_bb51_5206),
    pair(0x3fdc_c66e_9931_c45e, 0x3c56_850e_59c3_7f8f),
    pair(0x3fdd_7977_5b86_e389, 0x3c75_50ec_87bc_0575),
    pair(0x3fde_2b5d_3806_f63b, 0x3c5e_0d89_1d3c_6841),
    pair(0x3fde_dc19_52ef_78d6, 0xbc7d_d0f7_c33e_dee6),
    pair(0x3fdf_8ba4_dbf8_9aba, 0xbc32_ec1f_c1b7_76b8),
    pair(0x3fe0_1cfc_874c_3eb7, 0xbc73_4a35_e7c2_368c),
    pair(0x3fe0_7387_9922_ffee, 0xbc8a_5a01_4347_406c),
    pair(0x3fe0_c970_4d5d_898f, 0xbc88_d3d7_de6e_e9b2),
    pair(0x3fe1_1eb3_541b_4b23, 0xbc8e_f23b_69ab_e4f1),
    pair(0x3fe1_734d_63de_db49, 0xbc87_eef2_ccc5_0575),
    pair(0x3fe1_c73b_39ae_68c8, 0x3c8b_25dd_267f_6600),
    pair(0x3fe2_1a79_9933_eb59, 0xbc83_a7b1_77c6_8fb2),
    pair(0x3fe2_6d05_4cdd_12df, 0xbc85_da74_3ef3_770c),
    pair(0x3fe2_bedb_25fa_f3ea, 0xbc51_4981_c796_ee46),
    pair(0x3fe3_0ff7_fce1_7035, 0xbc6e_fcc6_26f7_4a6f),
    pair(0x3fe3_6058_b106_59f3, 0xbc81_fcb3_a358_57e7),
    pair(0x3fe3_affa_2920_50b9, 0x3c7e_3e25_e395_4964),
    pair(0x3fe3_fed9_5345_56d4, 0x3c83_6916_608c_5061),
    pair(0x3fe4_4cf3_2509_1dd6, 0x3c68_076a_2cfd_c6b3),
    pair(0x3fe4_9a44_9b9b_0939, 0xbc82_7ee1_6d71_9b94),
    pair(0x3fe4_e6ca_bbe3_e5e9, 0x3c63_c293_edce_b327),
    pair(0x3fe5_3282_92a3_5596, 0xbc7a_12eb_89da_0257),
    pair(0x3fe5_7d69_348c_eca0, 0xbc87_5720_992b_fbb2),
    pair(0x3fe5_c77b_be65_018c, 0x3c80_69ea_9c0b_c32a),
    pair(0x3fe6_10b7_551d_2cdf, 0xbc72_51b3_52ff_2a37),
    pair(0x3fe6_5919_25f0_783d, 0x3c8c_3d64_fbf5_de23),
    pair(0x3fe6_a09e_667f_3bcd, 0xbc8b_dd34_13b2_6456),
    pair(0x3fe6_e744_54ea_a8af, 0xbc8d_bc03_c84e_226e),
    pair(0x3fe7_2d08_37ef_ff96, 0x3c80_d4ef_0f1d_915c),
    pair(0x3fe7_71e7_5f03_7261, 0x3c75_cfce_8d84_068f),
    pair(0x3fe7_b5df_226a_afaf, 0xbc70_f537_acdf_0ad7),
    pair(0x3fe7_f8ec_e357_1771, 0xbc89_c8d8_ce93_c917),
    pair(0x3fe8_3b0e_0bff_976e, 0xbc76_f420_f8ea_3475),
    pair(0x3fe8_7c40_0fba_2ebf, 0xbc82_dabc_0c3f_64cd),
    pair(0x3fe8_bc80_6b15_1741, 0xbc82_c5e1_2ed1_336d),
    pair(0x3fe8_fbcc_a3ef_940d, 0xbc66_dfa9_9c86_f2f1),
    pair(0x3fe9_3a22_4992_63fb, 0x3c83_d419_a920_df0b),
    pair(0x3fe9_777e_f4c7_d742, 0xbc81_5479_a240_665e),
    pair(0x3fe9_b3e0_47f3_8741, 0xbc83_0ee2_8671_2474),
    pair(0x3fe9_ef43_ef29_af94, 0x3c7b_1dfc_b604_45c2),
    pair(0x3fea_29a7_a046_2782, 0xbc71_28bb_015d_f175),
    pair(0x3fea_6309_1b02_fae2, 0xbc7e_9111_5224_8d10),
    pair(0x3fea_9b66_290e_a1a3, 0x3c39_f630_e8b6_dac8),
    pair(0x3fea_d2bc_9e21_d511, 0xbc84_7fbe_07be_a548),
    pair(0x3feb_090a_5815_0200, 0xbc89_26da_300f_fcce),
    pair(0x3feb_3e4d_3ef5_5712, 0xbc8e_b6b8_bf11_a493),
    pair(0x3feb_7283_4519_6e3e, 0xbc8b_c69f_324e_6d61),
    pair(0x3feb_a5aa_6735_90d2, 0x3c87_ea4e_3707_53b6),
    pair(0x3feb_d7c0_ac6f_952a, 0xbc88_25a7_32ac_700a),
    pair(0x3fec_08c4_2672_5549, 0x3c5b_157f_d80e_2946),
    pair(0x3fec_38b2_f180_bdb1, 0xbc76_e0b1_757c_8d07),
    pair(0x3fec_678b_3488_739b, 0x3c6d_86ca_c7c5_ff5b),
    pair(0x3fec_954b_2134_11f5, 0xbc52_fb76_1e94_6603),
    pair(0x3fec_c1f0_f3fc_fc5c, 0x3c7e_5761_3b68_f6ab),
    pair(0x3fec_ed7a_f43c_c773, 0xbc5e_7b6b_b5ab_58ae),
    pair(0x3fed_17e7_743e_35dc, 0xbc51_01da_3540_130a),
    pair(0x3fed_4134_d14d_c93a, 0xbc84_ef52_95d2_5af2),
    pair(0x3fed_6961_73c9_e68b, 0xbc7e_8c61_c639_3d55),
    pair(0x3fed_906b_cf32_8d46, 0x3c74_57e6_1023_1ac2),
    pair(0x3fed_b652_6238_a09b, 0xbc7a_dee7_eae6_9460),
    pair(0x3fed_db13_b6cc_c23c, 0x3c88_3c37_c610_7db3),
    pair(0x3fed_feae_622d_be2b, 0xbc85_14ea_8842_5567),
    pair(0x3fee_2121_04f6_86e5, 0xbc80_14c7_6c12_6527),
    pair(0x3fee_426a_4b2b_c17e, 0x3c8a_8738_8974_4882),
    pair(0x3fee_6288_ec48_e112, 0xbc61_6b56_f284_7754),
    pair(0x3fee_817b_ab4c_d10d, 0xbc7d_0afe_686b_5e0a),
    pair(0x3fee_9f41_56c6_2dda, 0x3c87_60b1_e2e3_f81e),
    pair(0x3fee_bbd8_c8df_0b74, 0x3c7c_6c8c_615e_7277),
    pair(0x3fee_d740_e768_4963, 0x3c7e_82c7_91f5_9cc2),
    pair(0x3fee_f178_a3e4_73c2, 0x3c86_310a_67fe_774f),
    pair(0x3fef_0a7e_fb92_30d7, 0x3c75_2c7a_dc6b_4989),
    pair(0x3fef_2252_f776_3ada, 0xbc82_0cb8_1c8d_94ab),
    pair(0x3fef_38f3_ac64_e589, 0xbc7d_7baf_b51f_72e6),
    pair(0x3fef_4e60_3b0b_2f2d, 0xbc78_ee01_e695_ac05),
    pair(0x3fef_6297_cff7_5cb0, 0x3c75_6217_2a36_1fd3),
    pair(0x3fef_7599_a3a1_2077, 0x3c88_4f31_d743_195c),
    pair(0x3fef_8764_fa71_4ba9, 0x3c7a_b256_778f_fcb6),
    pair(0x3fef_97f9_24c9_099b, 0xbc8e_2ae0_eea5_963b),
    pair(0x3fef_a755_7f08_a517, 0xbc87_a0a8_ca13_571f),
    pair(0x3fef_b579_7195_d741, 0x3c71_bfac_7397_cc08),
    pair(0x3fef_c264_70e1_9fd3, 0x3c81_ec86_68ec_acee),
    pair(0x3fef_ce15_fd6d_a67b, 0xbc75_dd6f_830d_4c09),
    pair(0x3fef_d88d_a3d1_2526, 0xbc88_7df6_3788_11c7),
    pair(0x3fef_e1ca_fcbd_5b09, 0x3c6a_23e3_202a_884e),
    pair(0x3fef_e9cd_ad01_883a, 0x3c65_21ec_d0c6_7e35),
    pair(0x3fef_f095_658e_71ad, 0x3c80_1a8c_e18a_4b9e),
    pair(0x3fef_f621_e379_6d7e, 0xbc6c_57bc_2e24_aa15),
    pair(0x3fef_fa72_effe_f75d, 0xbc88_b4cd_cdb2_5956),
    pair(0x3fef_fd88_6084_cd0d, 0xbc81_354d_4556_e4cb),
    pair(0x3fef_ff62_169b_92db, 0x3c85_dda3_c81f_bd0d),
    pair(0x3ff0_0000_0000_0000, 0x0000_0000_0000_0000),
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
