"""The commands of the command line, one file each; `cli` loads the one that is asked for."""
