"""``python -m navsym``: the same as the console script ``navsym``."""

from navsym.cli.main import main

if __name__ == "__main__":
    main()
