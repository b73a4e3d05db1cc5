//! The size of work groups as a compute shader states it.

use std::collections::BTreeSet;

use super::fold::Const;
use super::{Shader, TokenPlace};

/// Invocations of a workgroup whose size a host chooses.
const USUAL: u32 = 64;

/// Words in names of constants that are the size of a workgroup.
const OF_SIZES: [&str; 5] = ["LOCAL_SIZE", "LOCALSIZE", "WORKGROUP", "GROUP_SIZE", "BLOCK_SIZE"];

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

    /// A size for work groups of which the text leaves all to its host: specialization constants are named for it, and
    /// declared nowhere. It is the value of another constant that is called so, or 64 invocations along the axes whose
    /// places the text asks for.
    pub fn usual_workgroup_size(&self) -> Option<[u32; 3]> {
        let layouts = || self.interface.stage_layouts.iter();
        let has = |key: &str| layouts().any(|layout| layout.qualifiers.layout_entry(key).is_some());
        let left = ["x", "y", "z"].into_iter().any(|axis| has(&format!("local_size_{axis}_id")));
        if !left || self.workgroup_size().is_some() {
            return None;
        }
        let constants = self.interface.constants.iter();
        let mut sizes = constants.filter(|constant| {
            let name = constant.name.to_uppercase();
            OF_SIZES.iter().any(|word| name.contains(word)) && constant.is_specialized()
        });
        let named = sizes.find_map(|constant| u32::try_from(constant.value?.as_integer()?).ok());
        Some(match (named.filter(|&n| n > 1), self.axes_of_invocations().len()) {
            (Some(n), _) => [n, 1, 1],
            (None, 0 | 1) => [USUAL, 1, 1],
            (None, 2) => [8, USUAL / 8, 1],
            (None, _) => [4, 4, USUAL / 16],
        })
    }

    /// Axes along which the text asks for the place of an invocation, in its dispatch or its work group.
    fn axes_of_invocations(&self) -> BTreeSet<char> {
        let tokens: Vec<&str> =
            self.tokens.iter().filter(|t| t.place == TokenPlace::Text).map(|t| self.file.slice(t.span)).collect();
        let places =
            (0..tokens.len()).filter(|&k| ["gl_GlobalInvocationID", "gl_LocalInvocationID"].contains(&tokens[k]));
        let of = |k: usize| match (tokens.get(k + 1), tokens.get(k + 2)) {
            (Some(&"."), Some(swizzle)) => swizzle.chars().collect::<Vec<char>>(),
            _ => vec!['x', 'y', 'z'],
        };
        places.flat_map(of).collect()
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
    fn what_is_left_to_the_host_is_chosen_by_what_is_asked() {
        let usual = |head: &str, body: &str| {
            let text = format!("#version 450\n{head}\nbuffer B {{ uint b[]; }};\nvoid main() {{ {body} }}\n");
            let parsed = Shader::parse(&SourceFile::new("a.comp", text), Stage::Compute);
            assert!(parsed.diagnostics.is_empty(), "{:?}", parsed.diagnostics);
            parsed.shader.usual_workgroup_size()
        };
        let all = "layout(local_size_x_id = 233, local_size_y_id = 234, local_size_z_id = 235) in;";
        assert_eq!(usual(all, "b[gl_GlobalInvocationID.x] = 1u;"), Some([64, 1, 1]));
        assert_eq!(usual(all, "b[gl_LocalInvocationID.x + gl_GlobalInvocationID.y] = 1u;"), Some([8, 8, 1]));
        assert_eq!(usual(all, "uvec3 at = gl_GlobalInvocationID; b[at.x] = 1u;"), Some([4, 4, 4]));
        let named = "layout(constant_id = 4) const uint LOCAL_SIZE = 256u;\n";
        assert_eq!(usual(&format!("{named}{all}"), "b[gl_LocalInvocationID.x] = LOCAL_SIZE;"), Some([256, 1, 1]));
        // What the text says is no choice.
        let declared = "layout(constant_id = 1) const uint N = 32u;\nlayout(local_size_x_id = 1) in;";
        assert_eq!(usual(declared, "b[gl_GlobalInvocationID.x] = 1u;"), None);
        assert_eq!(usual("layout(local_size_x = 8) in;", "b[gl_GlobalInvocationID.x] = 1u;"), None);
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
