//! Drawings in DXF.
