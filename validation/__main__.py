"""The command line: tools/prove SETTINGS.toml [--only-make] [--cases DIR] [--out DIR] [--set KEY=VALUE] ..."""
