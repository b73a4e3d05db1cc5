//! Rules on programs: shaders that are linked together.

// Rules: each in a folder with its name, with its pages.
pub(super) mod block_drift;
pub(super) mod frag_output_locations;
pub(super) mod geometry_bypass;
pub(super) mod input_without_producer;
pub(super) mod interface_type_mismatch;
pub(super) mod interpolation_mismatch;
pub(super) mod output_without_consumer;
pub(super) mod position_not_invariant;
pub(super) mod uniform_type_conflict;

use syntax::Stage;

/// The stage in Japanese, as a noun.
pub(super) fn stage_in_japanese(stage: Stage) -> &'static str {
    match stage {
        Stage::Vertex => "頂点シェーダ",
        Stage::TessControl => "テッセレーション制御シェーダ",
        Stage::TessEvaluation => "テッセレーション評価シェーダ",
        Stage::Geometry => "ジオメトリシェーダ",
        Stage::Fragment => "フラグメントシェーダ",
        Stage::Compute => "コンピュートシェーダ",
        Stage::Library => "ライブラリ",
    }
}
