//! Transcripts of the command.
