//! The page of a rule: Markdown beside its code, `en.md` and `ja.md`.
//!
//! A page starts with a title and a sentence; sections follow, each under its heading. Examples and references stand
//! in the English page alone, and are shown on the Japanese one in their places. An example is a file: its name in
//! backquotes, and its text in a fence.

use base::diagnostic::Lang;

/// The sections in the order in which they are shown: their headings in English and in Japanese, and whether the
/// Japanese page shows the text of the English one.
const SECTIONS: [(&str, &str, bool); 6] = [
    ("What", "内容", false),
    ("Why", "理由", false),
    ("Bad", "悪い例", true),
    ("Good", "良い例", true),
    ("Fix", "修正", false),
    ("References", "参考", true),
];

/// The texts of a rule's page.
pub struct Pages {
    /// In English, with examples and references.
    pub en: &'static str,
    /// In Japanese, without them.
    pub ja: &'static str,
}

/// A file of an example.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Example {
    /// Its name; the ending gives the language and the stage.
    pub name: &'static str,
    /// Its text.
    pub text: &'static str,
}

impl Pages {
    /// What the rule finds, in one line without a full stop.
    pub fn summary(&self, lang: Lang) -> String {
        let sentence = self.text(lang, "").split_once('\n').map_or("", |(_title, sentence)| sentence);
        joined(sentence, lang).trim_end_matches(['.', '。']).to_owned()
    }

    /// What the rule reports, and where it stays silent; each paragraph is one line.
    pub fn what(&self, lang: Lang) -> String {
        joined(self.section("What", lang), lang)
    }

    /// Why that is wrong or what happens; each paragraph is one line.
    pub fn why(&self, lang: Lang) -> String {
        joined(self.section("Why", lang), lang)
    }

    /// What the fix does and whether it is safe; each paragraph is one line.
    pub fn fix(&self, lang: Lang) -> String {
        joined(self.section("Fix", lang), lang)
    }

    /// Files in which the rule reports, and no other rule does.
    pub fn bad(&self) -> Vec<Example> {
        examples(self.section("Bad", Lang::En))
    }

    /// The same files repaired: no rule reports.
    pub fn good(&self) -> Vec<Example> {
        examples(self.section("Good", Lang::En))
    }

    /// The whole page, with the sections that both languages share.
    pub fn markdown(&self, lang: Lang) -> String {
        let mut page = format!("{}\n", self.text(lang, ""));
        for (english, japanese, _) in SECTIONS {
            let heading = if lang == Lang::Ja { japanese } else { english };
            page += &format!("\n## {heading}\n\n{}\n", self.section(english, lang));
        }
        page
    }

    /// What a language shows under a heading, which is given in English.
    fn section(&self, heading: &str, lang: Lang) -> &'static str {
        match SECTIONS.iter().find(|(english, ..)| *english == heading) {
            Some((_, japanese, false)) if lang == Lang::Ja => self.text(Lang::Ja, japanese),
            _ => self.text(Lang::En, heading),
        }
    }

    /// What stands under a heading, or above the first one for an empty heading; empty where the page has none such.
    fn text(&self, lang: Lang, heading: &str) -> &'static str {
        let page = if lang == Lang::Ja { self.ja } else { self.en };
        sections(page).into_iter().find(|(found, _)| *found == heading).map_or("", |(_, body)| body)
    }
}

/// The sections of a page with their headings; the first has an empty one.
fn sections(text: &'static str) -> Vec<(&'static str, &'static str)> {
    let mut found = Vec::new();
    let (mut heading, mut start, mut at, mut fenced) = ("", 0, 0, false);
    for line in text.split_inclusive('\n') {
        let end = at + line.len();
        fenced ^= line.starts_with("```");
        if let Some(next) = line.strip_prefix("## ").filter(|_| !fenced) {
            found.push((heading, text[start..at].trim()));
            (heading, start) = (next.trim_end(), end);
        }
        at = end;
    }
    found.push((heading, text[start..].trim()));
    found
}

/// The files of a section with examples.
fn examples(section: &'static str) -> Vec<Example> {
    let mut found = Vec::new();
    let mut rest = section;
    while let Some((name, behind)) = rest.split_once("\n\n```") {
        let Some((_language, behind)) = behind.split_once('\n') else { break };
        let Some(end) = behind.find("\n```") else { break };
        found.push(Example { name: name.trim().trim_matches('`'), text: &behind[..=end] });
        rest = behind[end..].trim_start_matches(['\n', '`']);
    }
    found
}

/// The same with each paragraph in one line. Japanese has no blanks between words.
fn joined(text: &str, lang: Lang) -> String {
    let blank = if lang == Lang::Ja { "" } else { " " };
    let paragraphs = text.split("\n\n").map(|p| p.lines().map(str::trim).filter(|l| !l.is_empty()));
    paragraphs.map(|lines| lines.collect::<Vec<_>>().join(blank)).collect::<Vec<_>>().join("\n\n").trim().to_owned()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::RULES;

    /// For rules that tests plant.
    pub const NO_PAGES: Pages = Pages { en: "", ja: "" };

    const PAGES: Pages = Pages {
        en: "# A001 a-rule (info)\n\nIt is\nwrong.\n\n## What\n\nThis\nand that.\n\nMore.\n\n## Why\n\nSo.\n\n## Bad\n\n\
             `a.vert`\n\n```glsl\n## x\n\ny\n```\n\n`a.cpp`\n\n```cpp\nz\n```\n\n## Good\n\n`a.vert`\n\n```glsl\nok\n```\n\n\
             ## Fix\n\nSafe.\n\n## References\n\n- A book\n",
        ja: "# A001 a-rule (info)\n\n誤り\nです。\n\n## 内容\n\nこれ。\n\n## 理由\n\n理。\n\n## 修正\n\n直す。\n",
    };

    #[test]
    fn parts_of_a_page_are_read() {
        assert_eq!(PAGES.summary(Lang::En), "It is wrong");
        assert_eq!(PAGES.summary(Lang::Ja), "誤りです");
        assert_eq!(PAGES.what(Lang::En), "This and that.\n\nMore.");
        assert_eq!((PAGES.why(Lang::Ja), PAGES.fix(Lang::Ja)), ("理。".to_owned(), "直す。".to_owned()));
        let bad = [("a.vert", "## x\n\ny\n"), ("a.cpp", "z\n")].map(|(name, text)| Example { name, text });
        assert_eq!(PAGES.bad(), bad);
        assert_eq!(PAGES.good(), [Example { name: "a.vert", text: "ok\n" }]);
    }

    #[test]
    fn the_japanese_page_shows_the_examples_of_the_english_one() {
        assert_eq!(PAGES.markdown(Lang::En), PAGES.en);
        let page = PAGES.markdown(Lang::Ja);
        let place = |part: &str| page.find(part).unwrap();
        assert!(place("## 理由") < place("## 悪い例\n\n`a.vert`\n\n```glsl\n## x"));
        assert!(place("## 良い例\n\n`a.vert`\n\n```glsl\nok") < place("## 修正\n\n直す。\n\n## 参考\n\n- A book\n"));
    }

    #[test]
    fn every_page_has_its_title_and_its_sections_in_order() {
        for rule in RULES {
            let title = format!("# {} {} ({})\n", rule.code, rule.name, rule.severity.name());
            let all = ["", "What", "Why", "Bad", "Good", "Fix", "References"];
            let own = ["", "内容", "理由", "修正"];
            for (text, wanted) in [(rule.pages.en, &all[..]), (rule.pages.ja, &own[..])] {
                assert!(text.starts_with(&title), "{title}");
                let found: Vec<_> = sections(text).into_iter().map(|(heading, _)| heading).collect();
                assert_eq!(found, wanted, "{}", rule.name);
                assert!(sections(text).iter().all(|(_, body)| !body.is_empty()), "{}: an empty section", rule.name);
            }
            // Nothing but files stands among the examples, and nothing of a page is lost when it is shown.
            assert_eq!(rule.pages.markdown(Lang::En), rule.pages.en, "{}", rule.name);
            for (heading, files) in [("Bad", rule.pages.bad()), ("Good", rule.pages.good())] {
                let written: Vec<String> = files.iter().map(written).collect();
                assert_eq!(written.join("\n\n"), rule.pages.section(heading, Lang::En), "{}", rule.name);
            }
        }
    }

    fn written(file: &Example) -> String {
        let language = match file.name.rsplit_once('.') {
            Some((_, ending @ ("cpp" | "js" | "rs" | "wgsl"))) => ending,
            _ => "glsl",
        };
        format!("`{}`\n\n```{language}\n{}```", file.name, file.text)
    }
}
