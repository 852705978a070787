"""The commands, one a file; `wedmcam.cli.main` has the table of them, and imports what runs."""
