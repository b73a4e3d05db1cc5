//! Host code that draws where depth is equal to what an earlier pass has written.

use base::text::Span;
use syntax::words::words;

/// Words between the name of the setting and its value, at most: `glDepthFunc(GL_EQUAL)`, `depth_compare:
/// Some(wgpu::CompareFunction::Equal)`.
const WORDS_BETWEEN: usize = 4;

/// The first place where a depth test is set to pass for equal depth alone, in any API and language.
pub fn equal_depth(text: &str) -> Option<Span> {
    text.match_indices("epth").find_map(|(at, _)| {
        let start = text[..at].trim_end_matches(is_part).len();
        let setting = Span::new(start, start + syntax::words::identifier(&text[start..]).len());
        if !sets_depth(&text[setting.start..setting.end]) || is_comment(text, setting.start) {
            return None;
        }
        let rest = &text[setting.end..];
        // A comparison asks, and a path names a value of the project's own.
        let asks = rest.trim_start().starts_with("::")
            || rest.trim_start().starts_with("==")
            || rest.trim_start().starts_with("!=");
        let end = rest.find([';', ',', '\n', '{', '}', '|', '?']).unwrap_or(rest.len());
        let value = rest[..end].split(|c: char| !is_part(c) && c != '-').filter(|w| !w.is_empty()).take(WORDS_BETWEEN);
        let equal = { value }.find(|word| is_equal(word))?;
        let end = setting.end + (equal.as_ptr() as usize - rest.as_ptr() as usize) + equal.len();
        (!asks).then_some(Span::new(setting.start, end))
    })
}

/// Whether passes of WebGPU begin with depth that an earlier one wrote: false where each of them is said to clear it, and none
/// where the text says nothing.
pub fn keeps_depth(text: &str) -> Option<bool> {
    let values = text.match_indices("depthLoadOp").filter(|(at, _)| !is_comment(text, *at)).map(|(at, name)| {
        let rest = &text[at + name.len()..];
        let value = rest.trim_start_matches(['?', ':', '=', ' ', '"', '\'', '`']);
        syntax::words::identifier(value)
    });
    values.map(|value| value != "clear").reduce(|any, one| any || one)
}

fn is_part(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// `glDepthFunc`, `depthCompare`, `depth_compare`, `depthCompareOp`, `depthCompareFunction`.
fn sets_depth(name: &str) -> bool {
    let words = words(name);
    let at = words.iter().position(|word| word == "depth");
    at.and_then(|at| words.get(at + 1))
        .is_some_and(|next| ["func", "function", "compare", "comparison"].contains(&next.as_str()))
}

/// `GL_EQUAL`, `VK_COMPARE_OP_EQUAL`, `eEqual`, `EqualDepth`, `MTLCompareFunctionEqual`, `D3D12_COMPARISON_FUNC_EQUAL`.
fn is_equal(name: &str) -> bool {
    let words = words(name);
    let words = words.strip_suffix(&["depth".to_owned()]).unwrap_or(&words);
    let (last, before) = match words {
        [] => return false,
        [before @ .., last] => (last, before.last()),
    };
    // The name of an API's own value: other words in front are those of a function or of another test.
    last == "equal" && before.is_none_or(|word| ["gl", "e", "op", "func", "function"].contains(&word.as_str()))
}

/// True behind `//`, or on a line of a comment that begins with `*`.
fn is_comment(text: &str, at: usize) -> bool {
    let line = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let before = text[line..at].trim_start();
    before.contains("//") || before.starts_with('*') || before.starts_with("/*")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_that_clear_depth_share_none() {
        assert_eq!(keeps_depth("depthLoadOp: 'clear', x\n"), Some(false));
        assert_eq!(keeps_depth("depthLoadOp: 'clear'\ndepthLoadOp: \"load\""), Some(true));
        assert_eq!(keeps_depth("depthLoadOp: first ? 'clear' : 'load'"), Some(true));
        assert_eq!(keeps_depth("// depthLoadOp: 'load'"), None);
    }

    #[test]
    fn tests_for_equal_depth_are_found_in_every_api() {
        for text in [
            "glDepthFunc(GL_EQUAL);",
            "gl.depthFunc(gl.EQUAL)",
            "depthStencil: { format, depthCompare: 'equal', depthWriteEnabled: false }",
            "depth_compare: wgpu::CompareFunction::Equal,",
            "depth_compare: Some(wgpu::CompareFunction::Equal),",
            "info.depthCompareOp = VK_COMPARE_OP_EQUAL;",
            ".setDepthCompareOp(vk::CompareOp::eEqual)",
            "descriptor.depthCompareFunction = MTLCompareFunctionEqual;",
            "material.depthFunc = THREE.EqualDepth;",
            "desc.DepthFunc = D3D12_COMPARISON_FUNC_EQUAL;",
            "GL11.glDepthFunc(GL11.GL_EQUAL);",
        ] {
            assert!(equal_depth(text).is_some(), "{text}");
        }
        let text = "x\n  glDepthFunc( GL_EQUAL );";
        let place = equal_depth(text).unwrap();
        assert_eq!(&text[place.start..place.end], "glDepthFunc( GL_EQUAL");
    }

    #[test]
    fn other_tests_tables_and_comments_are_not() {
        for text in [
            "glDepthFunc(GL_LEQUAL);",
            "gl.depthFunc(gl.GEQUAL)",
            "depthCompare: 'less-equal'",
            "depth_compare: wgpu::CompareFunction::LessEqual,",
            "info.depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL;",
            "material.depthFunc = THREE.LessEqualDepth;",
            "material.depthFunc = THREE.NotEqualDepth;",
            "export const COMPARERS = { depthFunc: strictEqual };",
            "// glDepthFunc(GL_EQUAL);",
            "if (state.depthFunc == GL_EQUAL) {",
            "case DepthFunc::Equal: return GL_EQUAL;",
            "enum DepthFunc { Never, Less, Equal };",
            "depthCompare?: 'never' | 'less' | 'equal'",
            "glStencilFunc(GL_EQUAL, 1, 0xff);",
            "float depth = 0; bool equal = true;",
        ] {
            assert_eq!(equal_depth(text), None, "{text}");
        }
    }
}
