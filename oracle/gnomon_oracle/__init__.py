"""gnomon's second oracle: it answers the same shadow rays, and draws the same scenes, with Mitsuba 3.

It reads numbers and writes numbers (docs/oracle.md describes the files). It never reads a scene file, and nothing that
it reads is ever executed.
"""
