//! Exit status of the commands.

use std::process::ExitCode;

/// How a command ended. The worse of two counts: [`Ord`] follows the exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ExitStatus {
    /// Nothing to complain about; exit code 0.
    Clean,
    /// Findings, or cases that failed; exit code 1.
    Findings,
    /// Usage, configuration, unreadable input, or a defect of our own; exit code 2.
    Error,
    /// The run was ended by this signal and reported what it had found; exit code 128 and its number.
    Interrupted(u8),
}

impl ExitStatus {
    /// 0, 1 or 2; 130 after SIGINT and 143 after SIGTERM.
    pub fn code(self) -> u8 {
        match self {
            Self::Clean => 0,
            Self::Findings => 1,
            Self::Error => 2,
            Self::Interrupted(signal) => 128_u8.saturating_add(signal),
        }
    }
}

impl From<ExitStatus> for ExitCode {
    fn from(status: ExitStatus) -> Self {
        Self::from(status.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worse_status_is_the_greater_one() {
        assert!(ExitStatus::Clean < ExitStatus::Findings && ExitStatus::Findings < ExitStatus::Error);
        assert_eq!(ExitStatus::Clean.max(ExitStatus::Error).code(), 2);
    }
}
