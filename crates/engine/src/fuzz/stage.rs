//! In which stage of a lane a program runs.

use judge::verdict::Translations;
use judge::verdict::diagnosis::{Diagnosis, Origin};
use lanes::{Lane, Stage};
use program::{Kernel, Language, Program, ProgramError, Written};

use base::value::Batch;
use program::lower::Role;

/// The stage of a lane in which a program runs: compute where there is that, else its own stage, and for a function the vertex
/// stage of a lane that calls functions there.
pub fn stage_of(lane: &dyn Lane, program: &Program) -> Stage {
    let stages = &lane.description().stages;
    match &program.role {
        _ if stages.contains(&Stage::Compute) => Stage::Compute,
        Role::Vertex if stages.contains(&Stage::Vertex) => Stage::Vertex,
        Role::Geometry(_) if stages.contains(&Stage::Geometry) => Stage::Geometry,
        Role::Function { .. } if lane.calls_functions() => Stage::Vertex,
        Role::Vertex | Role::Geometry(_) | Role::Function { .. } | Role::Fragment | Role::Compute => Stage::Compute,
    }
}

/// The kernel of a program for a stage.
///
/// # Errors
/// [`ProgramError`] for an input or output that cannot be captured.
pub fn kernel(program: &Program, stage: Stage) -> Result<Kernel, ProgramError> {
    match (stage, &program.role) {
        (Stage::Vertex, Role::Vertex) => {
            let components: Vec<u8> = program.inputs.iter().map(|port| port.field.shape.rows).collect();
            program.vertex_kernel(&components)
        }
        (Stage::Geometry, Role::Geometry(_)) => program.geometry_kernel(),
        _ => program.compute_kernel(),
    }
}

/// True for a deviation that the translator brings about which this tool puts between a text in GLSL and a driver: it drops
/// `precise`, or what it writes means something else when it is read back.
pub(super) fn is_of_own_translator(lane: &dyn Lane, program: &Program, batch: &Batch, diagnosis: &Diagnosis) -> bool {
    if program.written != Written::Glsl || !lane.front_end(program).starts_with("naga") {
        return false;
    }
    match &diagnosis.origin {
        Some(Origin::PreciseLost { .. }) => true,
        Some(Origin::BuiltIn { .. } | Origin::Rearrangement) => false,
        Some(_) | None => {
            let deviates = Translations::to(program, &[Language::SpirV]).deviates(Language::SpirV, batch);
            deviates.is_ok_and(|deviates| deviates.contains(&true))
        }
    }
}

/// The lane without that translator that is right wherever it ran, of those with what each gave.
pub(super) fn another<'r>(
    lanes: impl Iterator<Item = (&'r dyn Lane, &'r super::LaneReport)>,
    program: &Program,
) -> Option<(&'static str, String)> {
    lanes
        .map(|(lane, report)| (lane.front_end(program), lane.description().executor.as_str() == "interpreter", report))
        .find(|(front_end, interpreted, report)| {
            let wrong = report.verdicts.deviated + report.arbitrary.deviated;
            !front_end.starts_with("naga")
                && !interpreted
                && report.not_run.is_none()
                && wrong == 0
                && report.verdicts.agreed > 0
        })
        .map(|(front_end, _, report)| (report.lane, front_end))
}
