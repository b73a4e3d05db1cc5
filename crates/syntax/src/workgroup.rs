//! The size of work groups as a compute shader states it.

use super::Shader;
use super::fold::Const;

impl Shader {
    /// `layout(local_size_x = 8, …) in;` (GLSL 4.60, section 4.4.1.4), with a specialization constant where
    /// `local_size_x_id` names one that the shader declares: its value holds (GL_KHR_vulkan_glsl). An axis of which
    /// nothing is stated has size 1; none where no axis has a size, or one whose value is not known.
    pub fn workgroup_size(&self) -> Option<[u32; 3]> {
        let mut size = [None; 3];
        for layout in &self.interface.stage_layouts {
            for (slot, axis) in size.iter_mut().zip(["x", "y", "z"]) {
                let number = |key: &str| {
                    let entry = layout.qualifiers.layout_entry(key)?;
                    entry.value.and_then(|value| self.fold(value)).and_then(Const::as_integer)
                };
                let (stated, id) = (format!("local_size_{axis}"), format!("local_size_{axis}_id"));
                if layout.qualifiers.layout_entry(&stated).is_some() {
                    *slot = Some(u32::try_from(number(&stated)?).ok()?);
                }
                // A constant that is declared nowhere leaves the axis at what is stated.
                let special = number(&id).and_then(|id| self.specialization_constant(id));
                if let Some(value) = special {
                    *slot = Some(u32::try_from(value.as_integer()?).ok()?);
                }
            }
        }
        size.iter().any(Option::is_some).then(|| size.map(|s| s.unwrap_or(1)))
    }

    /// The value of `layout(constant_id = ID) const uint N = 32;`.
    fn specialization_constant(&self, id: i64) -> Option<Const> {
        let constants = self.interface.constants.iter();
        let mut values = constants.filter_map(|constant| {
            let own = constant.qualifiers.layout_entry("constant_id")?.value?;
            (self.fold(own)?.as_integer()? == id).then_some(constant.value)?
        });
        values.next()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Shader, Stage};
    use base::text::SourceFile;

    fn size(head: &str) -> Option<[u32; 3]> {
        let text = format!("#version 450\n{head}\nvoid main() {{}}\n");
        let parsed = Shader::parse(&SourceFile::new("a.comp", text), Stage::Compute);
        assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
        parsed.shader.workgroup_size()
    }

    #[test]
    fn the_size_is_stated_or_the_value_of_a_constant() {
        assert_eq!(size(""), None);
        assert_eq!(size("layout(local_size_x = 8, local_size_y = 4) in;"), Some([8, 4, 1]));
        let constant = "layout(constant_id = 3) const uint N = 32u;\n";
        assert_eq!(size(&format!("{constant}layout(local_size_x_id = 3) in;")), Some([32, 1, 1]));
        assert_eq!(size(&format!("layout(local_size_x_id = 3, local_size_y = 2) in;\n{constant}")), Some([32, 2, 1]));
        let both = "layout(local_size_x = 64) in;\nlayout(local_size_x_id = 3) in;\n";
        assert_eq!(size(&format!("{constant}{both}")), Some([32, 1, 1]), "the constant replaces the number");
        assert_eq!(size(&format!("{constant}layout(local_size_x = 64, local_size_x_id = 7) in;")), Some([64, 1, 1]));
    }
}
