//! The exact ray core.
