//! What can go wrong, in words that say where and what to do.

/// A failure, with place and remedy in its text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// A file's content is not what its format asks for.
    #[error("{place}: {what} ({remedy})")]
    Format {
        /// Line number or element path, for example `line 12, <ScatteringData>`.
        place: String,
        /// What was read and what was expected.
        what: String,
        /// What the person can do.
        remedy: String,
    },
    /// An argument is outside of what the operation accepts.
    #[error("{0}")]
    Argument(String),
    /// The model holds no data for what was asked.
    #[error("{0}")]
    Missing(String),
    /// The operation is not defined for this kind of model.
    #[error("{0}")]
    Unsupported(String),
    /// The operating system refused.
    #[error("{0}")]
    Io(String),
    /// The caller asked to stop (Ctrl-C).
    #[error("interrupted")]
    Interrupted,
}

impl Error {
    /// A [`Error::Format`] from its three parts.
    pub fn format(place: impl Into<String>, what: impl Into<String>, remedy: impl Into<String>) -> Self {
        Self::Format {
            place: place.into(),
            what: what.into(),
            remedy: remedy.into(),
        }
    }

    /// The same failure with more of its place in front, for example `layer 2: `.
    #[must_use]
    pub fn within(self, place: &str) -> Self {
        match self {
            Self::Format {
                place: inner,
                what,
                remedy,
            } => Self::Format {
                place: format!("{place}{inner}"),
                what,
                remedy,
            },
            Self::Argument(what) => Self::Argument(format!("{place}{what}")),
            Self::Missing(what) => Self::Missing(format!("{place}{what}")),
            Self::Unsupported(what) => Self::Unsupported(format!("{place}{what}")),
            Self::Io(what) => Self::Io(format!("{place}{what}")),
            Self::Interrupted => Self::Interrupted,
        }
    }
}

/// Result of anything in this crate.
pub type Result<T> = std::result::Result<T, Error>;
