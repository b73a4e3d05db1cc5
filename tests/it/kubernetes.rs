//! The manifests in `deploy/kubernetes`, checked without a cluster: every key is one that the API has at this place,
//! every value has its type, and what belongs together is the same.
//!
//! The structures follow `batch/v1` and `core/v1` for the parts that the manifests use; a key that is not listed here
//! is an error, as it is for a server with strict validation of fields.

use std::collections::BTreeMap;
use std::fs;

use serde::Deserialize;

use crate::binary::root;

#[derive(Debug, Deserialize)]
#[serde(tag = "kind", deny_unknown_fields)]
enum Manifest {
    Job(Job),
    PersistentVolumeClaim(Claim),
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct Job {
    api_version: String,
    metadata: Metadata,
    spec: JobSpec,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct Metadata {
    name: Option<String>,
    #[serde(default)]
    #[expect(dead_code, reason = "only its type is looked at")]
    labels: BTreeMap<String, String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
enum CompletionMode {
    Indexed,
    NonIndexed,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct JobSpec {
    completion_mode: Option<CompletionMode>,
    completions: Option<u32>,
    parallelism: Option<u32>,
    backoff_limit: u32,
    template: Template,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Template {
    #[expect(dead_code, reason = "only its type is looked at")]
    metadata: Metadata,
    spec: PodSpec,
}

/// What a job allows: `Always` is for other kinds.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
enum RestartPolicy {
    OnFailure,
    Never,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct PodSpec {
    restart_policy: RestartPolicy,
    #[expect(dead_code, reason = "only its type is looked at")]
    security_context: Option<SecurityContext>,
    containers: Vec<Container>,
    #[serde(default)]
    volumes: Vec<Volume>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
#[expect(dead_code, reason = "only types are looked at")]
struct SecurityContext {
    run_as_user: u64,
    run_as_group: u64,
    fs_group: u64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct Container {
    name: String,
    image: String,
    args: Vec<String>,
    #[serde(default)]
    env: Vec<Variable>,
    resources: Option<Resources>,
    #[serde(default)]
    volume_mounts: Vec<Mount>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Variable {
    name: String,
    value: String,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Resources {
    #[serde(default)]
    requests: BTreeMap<String, String>,
    #[serde(default)]
    limits: BTreeMap<String, String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct Mount {
    name: String,
    mount_path: String,
    #[serde(default)]
    read_only: bool,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct Volume {
    name: String,
    persistent_volume_claim: ClaimSource,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct ClaimSource {
    claim_name: String,
    #[serde(default)]
    read_only: bool,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct Claim {
    api_version: String,
    metadata: Metadata,
    spec: ClaimSpec,
}

#[expect(clippy::enum_variant_names, reason = "the names are those of the API")]
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
enum AccessMode {
    ReadWriteOnce,
    ReadOnlyMany,
    ReadWriteMany,
    ReadWriteOncePod,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
struct ClaimSpec {
    access_modes: Vec<AccessMode>,
    resources: Resources,
}

const FILES: [&str; 3] = ["storage.yaml", "shards.yaml", "merge.yaml"];

fn text(name: &str) -> String {
    fs::read_to_string(root().join("deploy/kubernetes").join(name)).unwrap()
}

/// What is wrong with the manifests: storage, shards, merge.
fn faults(texts: [&str; 3]) -> Vec<String> {
    let mut faults = Vec::new();
    let mut read = Vec::new();
    for (name, text) in FILES.iter().zip(texts) {
        match serde_norway::from_str::<Manifest>(text) {
            Ok(manifest) => read.push(manifest),
            Err(error) => faults.push(format!("{name}: {error}")),
        }
    }
    let [Manifest::PersistentVolumeClaim(claim), Manifest::Job(shards), Manifest::Job(merge)] = &read[..] else {
        return faults;
    };
    let mut unless = |holds: bool, fault: &str| {
        if !holds {
            faults.push(fault.to_owned());
        }
    };
    unless(claim.api_version == "v1", "claims are of v1");
    unless(claim.spec.access_modes.contains(&AccessMode::ReadWriteMany), "pods on several nodes write");
    unless(claim.spec.resources.requests.keys().eq(["storage"]), "a claim requests storage");
    for job in [shards, merge] {
        unless(job.api_version == "batch/v1", "jobs are of batch/v1");
        unless(job.metadata.name.as_deref().is_some_and(is_dns_label), "a job has a name");
        let pod = &job.spec.template.spec;
        for volume in &pod.volumes {
            let claimed = Some(&volume.persistent_volume_claim.claim_name) == claim.metadata.name.as_ref();
            unless(claimed, "a volume is the claim");
        }
        for container in &pod.containers {
            unless(is_dns_label(&container.name), "a container has a name");
            let version = format!("shadercheck:{}", env!("CARGO_PKG_VERSION"));
            unless(container.image == version, "the image is of this version");
            for mount in &container.volume_mounts {
                let volume = pod.volumes.iter().find(|volume| volume.name == mount.name);
                unless(volume.is_some(), "what is mounted is a volume");
                let writable = volume.is_none_or(|v| !v.persistent_volume_claim.read_only) || mount.read_only;
                unless(writable, "a read-only volume is mounted so");
                let named = container.args.contains(&mount.mount_path);
                unless(named, "the program is given the folder that is mounted");
            }
            let resources = container.resources.iter().flat_map(|r| r.requests.keys().chain(r.limits.keys()));
            for resource in resources {
                unless(["cpu", "memory"].contains(&resource.as_str()), "a container asks for cpu and memory");
            }
        }
    }
    unless(shards.spec.completion_mode == Some(CompletionMode::Indexed), "shards are an Indexed Job");
    let completions = shards.spec.completions.unwrap_or(0);
    unless(completions > 0 && shards.spec.parallelism.unwrap_or(1) <= completions, "not more pods than shards");
    unless(shards.spec.backoff_limit > 0, "a shard that was killed is started again");
    let container = &shards.spec.template.spec.containers[0];
    let count = container.env.iter().find(|v| v.name == engine::shard::COUNT);
    let same = count.is_some_and(|count| count.value == completions.to_string());
    unless(same, "SHADERCHECK_SHARD_COUNT is the number of completions");
    unless(merge.spec.completion_mode.is_none_or(|mode| mode == CompletionMode::NonIndexed), "one pod merges");
    unless(merge.spec.template.spec.restart_policy == RestartPolicy::Never, "a merge that found something stays");
    // The program takes the arguments.
    for job in [shards, merge] {
        let args = &job.spec.template.spec.containers[0].args;
        let words = std::iter::once("shadercheck").chain(args.iter().map(String::as_str));
        if let Err(error) = <shadercheck::cli::Cli as clap::Parser>::try_parse_from(words) {
            faults.push(format!("the program does not take its arguments: {error}"));
        }
    }
    faults
}

/// A name as the API takes it: lower case letters, digits and hyphens, at most 63.
fn is_dns_label(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
    !name.is_empty() && name.len() <= 63 && name.chars().all(plain) && !name.starts_with('-') && !name.ends_with('-')
}

#[test]
fn the_manifests_are_what_a_server_takes() {
    let texts = FILES.map(text);
    assert_eq!(faults([&texts[0], &texts[1], &texts[2]]), Vec::<String>::new());
}

#[test]
fn planted_faults_are_reported() {
    let [storage, shards, merge] = FILES.map(text);
    let reported = |from: &str, to: &str, part: &str| {
        assert!(shards.contains(from), "{from}");
        let planted = shards.replacen(from, to, 1);
        let faults = faults([&storage, &planted, &merge]);
        assert!(faults.iter().any(|fault| fault.contains(part)), "`{to}`: {faults:?}");
    };
    reported("completionMode", "completionsMode", "unknown field `completionsMode`");
    reported("completionMode: Indexed", "completionMode: indexed", "unknown variant `indexed`");
    reported("completionMode: Indexed", "completionMode: NonIndexed", "shards are an Indexed Job");
    reported("backoffLimit: 32", "backoffLimit: many", "invalid type");
    reported("value: \"16\"", "value: 16", "invalid type");
    reported("value: \"16\"", "value: \"8\"", "SHADERCHECK_SHARD_COUNT is the number of completions");
    reported("completions: 16", "completions: 15", "not more pods than shards");
    reported("restartPolicy: OnFailure", "restartPolicy: Always", "unknown variant `Always`");
    reported("batch/v1", "batch/v1beta1", "jobs are of batch/v1");
    reported("claimName: shadercheck-shards", "claimName: shards", "a volume is the claim");
    reported("mountPath: /shards", "mountPath: /results", "the program is given the folder that is mounted");
    reported("            - --shard\n", "            - --shared\n", "the program does not take its arguments");
    reported("          volumeMounts:\n", "      volumeMounts:\n", "shards.yaml: ");
    let planted = storage.replace("ReadWriteMany", "ReadWriteOnce");
    assert_eq!(faults([&planted, &shards, &merge]), ["pods on several nodes write"]);
    let planted = merge.replace("restartPolicy: Never", "restartPolicy: OnFailure");
    assert_eq!(faults([&storage, &shards, &planted]), ["a merge that found something stays"]);
}
