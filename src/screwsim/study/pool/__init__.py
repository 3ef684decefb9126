"""The work of a study on all cores: workers, progress, and the time that a case may take."""
