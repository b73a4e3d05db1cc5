//! Names of extensions.

use super::super::errors;
use super::Preprocessor;
use base::diagnostic::message;
use base::text::Span;

impl Preprocessor<'_> {
    /// `require` of something that no vendor can have made, and `all` with a behaviour that it cannot have.
    pub(super) fn known_extension(&mut self, name: &str, behavior: &str, span: Span) {
        const VENDORS: &[&str] = &[
            "ARB", "EXT", "OES", "NV", "NVX", "AMD", "ATI", "INTEL", "KHR", "APPLE", "ANDROID", "MESA", "OVR", "QCOM",
            "ARM", "IMG", "SGI", "SGIS", "SGIX", "WEBGL", "GOOGLE", "3DFX", "VIV", "DMP", "FJ", "HUAWEI", "ANGLE",
            "CHROMIUM", "WIN", "IBM", "MTX", "PGI", "REND", "S3", "SUN", "NOUVEAU",
        ];
        if name == "all" && matches!(behavior, "require" | "enable") {
            return self.malformed(span, "`all` can only be `warn` or `disable`");
        }
        let made = name.strip_prefix("GL_").and_then(|n| n.split('_').next()).is_some_and(|v| VENDORS.contains(&v));
        if behavior == "require" && !made && name != "all" {
            let d = self
                .sink
                .start(
                    errors::EXTENSION,
                    span,
                    message!("there is no extension `{name}`", "拡張 `{name}` は存在しません"),
                )
                .with_label(message!("required here", "ここで必須とされています"))
                .with_why(message!(
                    "a required extension that is not there is an error",
                    "必須の拡張がないとエラーになります"
                ))
                .with_help(message!("check its name, or write `enable`", "名前を確かめるか `enable` にしてください"));
            self.sink.push(d);
        }
    }
}
