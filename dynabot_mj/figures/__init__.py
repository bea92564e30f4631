"""Every figure, one file per subject; `style` says how all of them look.

Comes in: whatever draws with Matplotlib; nobody else does, but for the report's SVG.
"""
