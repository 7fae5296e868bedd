//! Classes of strokes, and how each class looks: its colour on a screen, and its width and dashes in print.

use super::{Move, text};
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::toolpath::Role;

/// The meaning of a stroke. Later classes are drawn over earlier ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    Band,
    Solid,
    Wall,
    Wire,
    ToolAxis,
    Curve,
    Uncut,
    Pose,
    Rapid,
    Link,
    CutLine,
    CutArc,
    CutParabola,
    Entry,
    Joint,
    Finding,
}

impl Class {
    pub const ALL: [Class; 16] = [
        Class::Band,
        Class::Solid,
        Class::Wall,
        Class::Wire,
        Class::ToolAxis,
        Class::Curve,
        Class::Uncut,
        Class::Pose,
        Class::Rapid,
        Class::Link,
        Class::CutLine,
        Class::CutArc,
        Class::CutParabola,
        Class::Entry,
        Class::Joint,
        Class::Finding,
    ];

    /// The name of the class in the style sheet.
    pub fn name(self) -> &'static str {
        match self {
            Class::Band => "band",
            Class::Solid => "body-edge",
            Class::Wall => "wall",
            Class::Wire => "wire",
            Class::ToolAxis => "tool-axis",
            Class::Curve => "curve",
            Class::Uncut => "uncut",
            Class::Pose => "pose",
            Class::Rapid => "rapid",
            Class::Link => "link",
            Class::CutLine => "cut",
            Class::CutArc => "cut-arc",
            Class::CutParabola => "cut-parabola",
            Class::Entry => "entry",
            Class::Joint => "joint",
            Class::Finding => "finding",
        }
    }

    /// The text in the legend.
    pub fn label(self) -> &'static str {
        match self {
            Class::Band => "band",
            Class::Solid => "stock, walls, fixtures",
            Class::Wall => "wall, island",
            Class::Wire => "surface",
            Class::ToolAxis => "tool axis, at even times",
            Class::Curve => "curve",
            Class::Uncut => "uncut",
            Class::Pose => "given pose",
            Class::Rapid => "rapid",
            Class::Link => "link",
            Class::CutLine => "cut, line",
            Class::CutArc => "cut, arc",
            Class::CutParabola => "cut, parabola",
            Class::Entry => "plunge, ramp, lead",
            Class::Joint => "joint",
            Class::Finding => "finding",
        }
    }

    /// Colours from the palette of Okabe and Ito, which colour-blind readers can distinguish. Widths are mm
    /// of paper.
    fn style(self) -> &'static str {
        match self {
            Class::Band => "stroke:#8a8a8a;stroke-width:.13;stroke-dasharray:1 .6;stroke-linecap:butt",
            Class::Solid => "stroke:#6a4a2a;stroke-width:.25;stroke-dasharray:3 .8 .4 .8;stroke-linecap:butt",
            Class::Wall => "stroke:#000;stroke-width:.25",
            Class::Wire => "stroke:#8a8a8a;stroke-width:.13",
            Class::ToolAxis => "stroke:#c7895b;stroke-width:.18",
            Class::Curve => "stroke:#000;stroke-width:.13",
            Class::Uncut => "stroke:#c00000;stroke-width:.45",
            Class::Pose => "stroke:#6a6a6a;stroke-width:.6",
            Class::Rapid => "stroke:#d55e00;stroke-width:.18;stroke-dasharray:1.8 1.2;stroke-linecap:butt",
            Class::Link => "stroke:#b0508a;stroke-width:.3;stroke-dasharray:2.4 .7 .5 .7;stroke-linecap:butt",
            Class::CutLine => "stroke:#0072b2;stroke-width:.18",
            Class::CutArc => "stroke:#00734f;stroke-width:.35",
            Class::CutParabola => "stroke:#56b4e9;stroke-width:.5",
            Class::Entry => "stroke:#e69f00;stroke-width:.6;stroke-dasharray:.01 1",
            Class::Joint => "stroke:#000;stroke-width:.8",
            Class::Finding => "stroke:#c00000;stroke-width:1.6",
        }
    }
}

/// The class and the curve of a move; `None` where the tip rests.
pub fn of(step: &Move) -> Option<(Class, Curve)> {
    match step {
        Move::Rapid { line } => Some((Class::Rapid, Curve::Line(*line))),
        Move::Feed { along, role, .. } => {
            let class = match (role, along) {
                (Role::Cut, Curve::Line(_)) => Class::CutLine,
                (Role::Cut, Curve::Arc(_)) => Class::CutArc,
                (Role::Cut, Curve::Parabola(_)) => Class::CutParabola,
                (Role::Link, _) => Class::Link,
                (Role::Plunge | Role::Ramp | Role::LeadIn | Role::LeadOut, _) => Class::Entry,
            };
            Some((class, *along))
        }
        Move::Turn { .. } | Move::Dwell { .. } => None,
    }
}

/// The style sheet. Every rule starts with `.plot`, so that inside a page it affects the picture only.
pub fn style() -> String {
    let strokes: String =
        Class::ALL.iter().map(|class| format!(".plot .{}{{{}}}", class.name(), class.style())).collect();
    format!(
        ".plot{{background:#fff}}\
         .plot path,.plot line{{fill:none;stroke:#000;stroke-width:.25;stroke-linecap:round;stroke-linejoin:round}}\
         .plot text{{font-family:sans-serif;font-size:{}px;fill:#000}}\
         .plot .sheet{{fill:#fff}}\
         .plot .frame{{fill:none;stroke:#000;stroke-width:.25}}\
         .plot .grid{{stroke:#ddd;stroke-width:.1}}\
         .plot .title{{font-size:{}px;font-weight:bold}}\
         .plot .small{{font-size:2.1px}}.plot .smaller{{font-size:1.8px}}.plot .smallest{{font-size:1.5px}}\
         .plot .head{{font-weight:bold}}\
         .plot .axis{{font-style:italic;font-weight:bold}}\
         .plot .right{{text-anchor:end}}.plot .middle{{text-anchor:middle}}\
         .plot .solid{{fill:#000;stroke:#fff;stroke-width:.15}}\
         .plot .datum{{fill:#fff;stroke:#000;stroke-width:.2}}\
         .plot .start{{fill:#fff;stroke:#000;stroke-width:.35}}\
         .plot .end{{stroke-width:.45}}{strokes}",
        text::SIZE_MM,
        text::TITLE_SIZE_MM,
    )
}
