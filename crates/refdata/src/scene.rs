//! Formulas that are geometry, as scenes in glTF 2.0: what other programs show and deform themselves.

use engine::catalogue;
use serde_json::json;

use super::document::{SCHEMA, SCHEMA_VERSION};

/// Why a formula has no scene.
#[derive(Clone, Debug, thiserror::Error, PartialEq, Eq)]
#[error("`{0}` is no geometry; scenes are made of {list}", list = formulas())]
pub struct NoScene(pub String);

fn formulas() -> String {
    catalogue::scenes().map(|scene| scene.formula).collect::<Vec<_>>().join(", ")
}

/// The scene of a formula with about this many vertices, as the bytes of a GLB file.
///
/// # Errors
/// [`NoScene`] for a formula that is no geometry.
pub fn scene(formula: &str, vertices: u64) -> Result<Vec<u8>, NoScene> {
    let scene = catalogue::scenes().find(|scene| scene.formula == formula);
    let scene = scene.ok_or_else(|| NoScene(formula.to_owned()))?;
    let source = catalogue::formula(formula).map_or("", |f| f.source);
    let asset = json!({
        "version": "2.0",
        "generator": concat!("shadercheck ", env!("CARGO_PKG_VERSION")),
        "extras": { "schema": SCHEMA, "schema_version": SCHEMA_VERSION, "formula": formula, "source": source },
    });
    Ok((scene.glb)(vertices, asset))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_says_what_made_it_and_others_are_refused() {
        let bytes = scene("sphere", 10).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("\"generator\":\"shadercheck 0.1.0\"") && text.contains("\"formula\":\"sphere\""));
        assert_eq!(
            scene("bone_weight", 10).unwrap_err().to_string(),
            "`bone_weight` is no geometry; scenes are made of sphere, cylinder, morph, morph_targets, joints, \
             two_bones, skinning, hair, catmull_rom"
        );
    }
}
