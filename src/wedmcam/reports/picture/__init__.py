"""Pictures of drawings, plans and programs as SVG and HTML."""
