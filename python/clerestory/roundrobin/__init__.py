"""The round robin: data sets of several laboratories through the same analyses, and what the differences come from.

* `study`: which systems, laboratories, files and settings; `load` reads a study, `of_files` makes one of files.
* `run`: every analysis, each piece kept in a cache under all that it depends on.
* `report`: the document of what was found; `results`: its numbers as files.
"""
