//! Methods of common helper classes that wrap functions of OpenGL. Data.

use crate::Wrapped;

/// A method whose first argument is the name of a uniform or attribute.
pub struct Preset {
    /// Name of the method.
    pub method: &'static str,
    /// What it does.
    pub kind: Wrapped,
    /// The function of OpenGL whose types it has, when that is clear.
    pub like: Option<&'static str>,
}

const fn set(method: &'static str, like: &'static str) -> Preset {
    Preset { method, kind: Wrapped::SetUniform, like: Some(like) }
}

const fn plain(method: &'static str, kind: Wrapped) -> Preset {
    Preset { method, kind, like: None }
}

/// The methods. Each is called on an object with a string literal first; that is unmistakable.
pub const PRESETS: &[Preset] = &[
    set("setBool", "glUniform1i"),
    set("setInt", "glUniform1i"),
    set("setFloat", "glUniform1f"),
    set("setVec2", "glUniform2fv"),
    set("setVec3", "glUniform3fv"),
    set("setVec4", "glUniform4fv"),
    set("setMat2", "glUniformMatrix2fv"),
    set("setMat3", "glUniformMatrix3fv"),
    set("setMat4", "glUniformMatrix4fv"),
    set("SetUniform1i", "glUniform1i"),
    set("SetUniform1f", "glUniform1f"),
    set("SetUniform2f", "glUniform2f"),
    set("SetUniform3f", "glUniform3f"),
    set("SetUniform4f", "glUniform4f"),
    set("SetUniformMat4f", "glUniformMatrix4fv"),
    set("setUniform1i", "glUniform1i"),
    set("setUniform1f", "glUniform1f"),
    set("setUniform2f", "glUniform2f"),
    set("setUniform3f", "glUniform3f"),
    set("setUniform4f", "glUniform4f"),
    set("setUniformMat4f", "glUniformMatrix4fv"),
    set("SetInteger", "glUniform1i"),
    set("SetVector2f", "glUniform2fv"),
    set("SetVector3f", "glUniform3fv"),
    set("SetVector4f", "glUniform4fv"),
    set("SetMatrix4", "glUniformMatrix4fv"),
    set("UploadUniformInt", "glUniform1i"),
    set("UploadUniformFloat", "glUniform1f"),
    set("UploadUniformFloat2", "glUniform2fv"),
    set("UploadUniformFloat3", "glUniform3fv"),
    set("UploadUniformFloat4", "glUniform4fv"),
    set("UploadUniformMat3", "glUniformMatrix3fv"),
    set("UploadUniformMat4", "glUniformMatrix4fv"),
    set("SetBool", "glUniform1i"),
    set("SetInt", "glUniform1i"),
    set("SetFloat", "glUniform1f"),
    set("SetVec2", "glUniform2fv"),
    set("SetVec3", "glUniform3fv"),
    set("SetVec4", "glUniform4fv"),
    set("SetMat3", "glUniformMatrix3fv"),
    set("SetMat4", "glUniformMatrix4fv"),
    set("setUniformMat4", "glUniformMatrix4fv"),
    plain("setUniform", Wrapped::SetUniform),
    plain("setUniformValue", Wrapped::SetUniform),
    plain("uniformLocation", Wrapped::UniformLocation),
    plain("attributeLocation", Wrapped::AttributeLocation),
    plain("getUniformLocation", Wrapped::UniformLocation),
    plain("GetUniformLocation", Wrapped::UniformLocation),
    plain("AddUniform", Wrapped::UniformLocation),
    plain("AddAttribute", Wrapped::AttributeLocation),
];
