//! From strokes to uplift: transport, plates, folds, isostasy, rock.

#[path = "../common/folds.rs"]
mod fold_common;
mod fold_shape;
mod fold_skeleton;
mod isostasy;
mod plates;
mod rock_file;
mod transport;
mod uplift;
