//! The path data of a view by level and class.

use std::collections::BTreeSet;

use super::class::Class;
use super::pen::Pen;
use toolpathd_core::toolpath::Toolpath;

/// A sheet with more levels does not part its paths by levels: each level has paths of its own.
const MOST_LEVELS: usize = 200;

/// The path data of one level by class.
#[derive(Debug, Clone, Default)]
pub struct Layer {
    /// `None` for all that is on no level.
    pub level: Option<u32>,
    pub paths: [String; Class::ALL.len()],
}

/// The pens of a view.
pub struct Pens {
    pens: [Pen; Class::ALL.len()],
    raster_mm: Option<f64>,
    layers: Vec<Layer>,
    level: Option<u32>,
    /// The bytes of the path data of all layers.
    n_bytes: usize,
}

impl Pens {
    pub fn new(raster_mm: Option<f64>) -> Self {
        let pens = Class::ALL.map(|_| Pen::new(raster_mm));
        Self { pens, raster_mm, layers: Vec::new(), level: None, n_bytes: 0 }
    }

    pub fn pen(&mut self, class: Class) -> &mut Pen {
        &mut self.pens[class as usize]
    }

    /// What is drawn from now on belongs to a level. With a raster there are no levels: strokes of one level
    /// stand for those of others.
    pub fn turn_to(&mut self, level: Option<u32>) {
        if level != self.level && self.raster_mm.is_none() {
            self.end_layer();
            self.level = level;
        }
    }

    /// The length of the path data so far, bytes.
    pub fn bytes(&self) -> usize {
        self.n_bytes + self.pens.iter().map(Pen::bytes).sum::<usize>()
    }

    /// The layers, from the lowest number of a level to the highest one.
    pub fn finish(mut self) -> Vec<Layer> {
        self.end_layer();
        self.layers.sort_by_key(|layer| layer.level);
        self.layers
    }

    fn end_layer(&mut self) {
        let raster_mm = self.raster_mm;
        let ended = std::mem::replace(&mut self.pens, Class::ALL.map(|_| Pen::new(raster_mm)));
        let ended = ended.map(Pen::finish);
        self.n_bytes += ended.iter().map(String::len).sum::<usize>();
        match self.layers.iter_mut().find(|layer| layer.level == self.level) {
            Some(layer) => layer.paths.iter_mut().zip(ended).for_each(|(path, more)| path.push_str(&more)),
            None => self.layers.push(Layer { level: self.level, paths: ended }),
        }
    }
}

/// The level of each pass of a toolpath; `None` for each where the toolpath has too many levels.
pub fn levels(toolpath: &Toolpath) -> Vec<Option<u32>> {
    let told = toolpath.passes().iter().map(|pass| pass.level());
    let different: BTreeSet<u32> = told.clone().flatten().collect();
    told.map(|level| level.filter(|_| different.len() <= MOST_LEVELS)).collect()
}

/// The classes with a stroke in some layer.
pub fn used<'a>(layers: impl Iterator<Item = &'a Layer> + Clone) -> Vec<Class> {
    let is_used = |class: &Class| layers.clone().any(|layer| !layer.paths[*class as usize].is_empty());
    Class::ALL.into_iter().filter(is_used).collect()
}

/// The paths of a view, each with an id and a title, so that a page can style and explain it. Paths on a
/// level have the number of their level.
pub fn strokes(view: &str, layers: &[Layer]) -> String {
    let mut out = String::new();
    for class in Class::ALL {
        let (name, label) = (class.name(), class.label());
        for Layer { level, paths } in layers {
            let data = &paths[class as usize];
            if data.is_empty() {
                continue;
            }
            let (id, of_level, title) = match level {
                None => (format!("{view}-{name}"), String::new(), label.to_owned()),
                Some(level) => (
                    format!("{view}-{name}-{level}"),
                    format!(" data-level=\"{level}\""),
                    // People count levels from 1.
                    format!("{label}, level {}", u64::from(*level) + 1),
                ),
            };
            out += &format!(
                "<path class=\"{name}\" d=\"{data}\" id=\"{id}\"{of_level}><title>{title}</title></path>\n"
            );
        }
    }
    out
}
