"""python -m bikesim"""

import sys

from bikesim.cli.main import main

sys.exit(main())
