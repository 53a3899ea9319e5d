"""`python -m clerestory` is the command line."""

import sys

from clerestory.cli import main

sys.exit(main())
