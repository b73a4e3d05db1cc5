//! Texts that templates make.
use super::*;
#[test]
fn dbg() {
    let p = std::env::var("DBG").unwrap();
    let file = SourceFile::new(p.clone(), std::fs::read_to_string(&p).unwrap());
    let code = Code::new(&file, Language::JavaScript);
    let mut files = Files::new(&file);
    let mut imp = |from: &str, path: &str| {
        let q = std::path::Path::new(from).parent().unwrap().join(path);
        let q = q.canonicalize().ok()?;
        Some(SourceFile::new(q.display().to_string(), std::fs::read_to_string(&q).ok()?))
    };
    for _ in 0..8 {
        read(&code, &files, &[]);
        if !files.read(&mut imp) {
            break;
        }
    }
    for (at, token) in code.tokens.iter().enumerate() {
        let Token::String { place, inner, form } = *token else { continue };
        if form != Form::Template {
            continue;
        }
        let values = Values::new(&files);
        let scope = Scope { file: 0, frame: frames(&code, &values, at) };
        let Some(text) = values.text(inner, form, &scope, 0) else {
            println!("NONE {place:?}");
            continue;
        };
        let open = values.open.take();
        let closed = holes::closed(&text, &open);
        if closed.file.text().len() < 300 {
            continue;
        }
        println!("=== {}", closed.file.text());
        for d in Shader::parse_wgsl(&closed.file).diagnostics {
            println!("{} {} {}", d.code.0, d.message, closed.file.locate(d.span.start));
        }
    }
}
