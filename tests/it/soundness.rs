//! The judge never accuses a device that keeps its promise, and does accuse one that does not.

use shadercheck::suite::run::soundness::{Request, check};
use shadercheck::suite::run::{Prepared, prepare};
use shadercheck::suite::{parse, shipped};
use shadercheck::text::SourceFile;

fn suites() -> Vec<Prepared> {
    let ready = shipped().iter().map(|suite| {
        let parsed = parse(&SourceFile::new(suite.path, suite.toml)).unwrap();
        prepare(&parsed, &SourceFile::new(suite.shader_name, suite.shader_text)).unwrap()
    });
    ready.collect()
}

#[test]
fn no_conforming_device_is_accused() {
    let n: u64 = std::env::var("N").ok().and_then(|n| n.parse().ok()).unwrap_or(100_000);
    let suites = suites();
    let start = std::time::Instant::now();
    let found = check(&suites, &Request::new(n, 1), &mut |_| {}).unwrap();
    eprintln!("{:?} judged {} undetermined {} violations {}", start.elapsed(), found.judged(), found.undetermined(), found.violations());
    for (k, s) in suites.iter().enumerate() {
        let rows = found.rows.iter().filter(|r| r.suite == k);
        let (mut j, mut u, mut v) = (0, [0; 6], 0);
        rows.clone().for_each(|r| { j += r.judged; v += r.violations; u.iter_mut().zip(r.undetermined).for_each(|(a, b)| *a += b) });
        let used = rows.filter_map(|r| r.used.as_ref().map(|u| (u.part, &u.component, r.behaviour.profile.name.as_str(), r.behaviour.strategy, r.behaviour.rearranges, r.behaviour.stage))).max_by(|a, b| a.0.total_cmp(&b.0));
        eprintln!("{} judged {j} undetermined {u:?} violations {v} used {used:?}", s.suite.name);
    }
    for v in &found.violations {
        eprintln!("{} {} {:?} {:?} re={} {} ratio {} {}", v.suite, v.behaviour.profile.name, v.behaviour.stage, v.behaviour.strategy, v.behaviour.rearranges, v.component, v.ratio, v.deviation);
    }
    assert_eq!(found.violations(), 0);
}
