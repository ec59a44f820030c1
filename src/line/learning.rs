//! What the lines of a row of pixels note of them: how they stand out of what is around, and what their edge looks like.

use super::table::Table;
use super::track::{State, Track};
use super::tuning::models_a_row;
use super::turns::looks;
use crate::edge::{EdgeModel, EdgePoint, Neighbours, PixelRow, Untracked};
use crate::format::Pixels;

/// Looks at what is around the confirmed lines that this row has shown, and gives the newest of those that lack one a
/// model of their edge.
pub(super) fn look_at<P: Pixels, const LINES: usize, const KNOTS: usize>(
    table: &mut Table<LINES, KNOTS>,
    row: u16,
    pixels: PixelRow<'_, P>,
    noise_q8: u32,
    points: &[EdgePoint],
) {
    let (is_due, mut has_to_learn) = (looks(row), false);
    let (places, mut tracks) = table.places_and_tracks();
    for place in places {
        let is_seen = |track: &&mut Track<KNOTS>| track.state == State::Confirmed && track.line.last().row == row;
        if let Some(track) = tracks.get_mut(*place).filter(is_seen) {
            has_to_learn |= track.model.is_none();
            if is_due && !track.is_unseen() {
                track.look_around(pixels);
            }
        }
    }
    if !has_to_learn {
        return;
    }
    let mut last = (0, 0, 0);
    for _ in 0..models_a_row(LINES) {
        let Some(next) = newest_to_learn(table, row, last) else { return };
        let (.., place) = next;
        if let Some(track) = table.track_mut(place).filter(|track| track.is_unseen()) {
            track.look_around(pixels);
        }
        learn(table, place, pixels, noise_q8, points);
        last = next;
    }
}

/// The newest line after the last one, by its points and its turn, of those that lack a model, and its place: one that
/// no model fits must not keep others from their turn.
fn newest_to_learn<const LINES: usize, const KNOTS: usize>(
    table: &Table<LINES, KNOTS>,
    row: u16,
    last: (u16, u16, u16),
) -> Option<(u16, u16, u16)> {
    // Fewer than 2¹⁶.
    let models = models_a_row(LINES) as u16;
    let asking = table.under_way().iter().filter_map(|place| {
        let track = table.track(*place).filter(|track| track.is_to_learn(row))?;
        let turn = place.wrapping_sub(row.wrapping_mul(models)).checked_rem(LINES as u16)?;
        Some((track.line.points(), turn, *place))
    });
    asking.filter(|line| *line > last).min()
}

/// Gives a line a model of its edge, from the row in which it was last seen, of which there are these other points.
fn learn<P: Pixels, const LINES: usize, const KNOTS: usize>(
    table: &mut Table<LINES, KNOTS>,
    place: u16,
    pixels: PixelRow<'_, P>,
    noise_q8: u32,
    points: &[EdgePoint],
) {
    let Some(point) = table.track(place).map(|track| *track.line.last()) else { return };
    let of_row = table.tracks_under_way().map(|track| track.line.last()).filter(|last| last.row == point.row);
    let lines = Neighbours::among_lines(of_row.clone(), &point);
    let untracked = Neighbours::among(points.iter(), &point).where_nearer_than(lines);
    let settled = |lines: Neighbours| EdgeModel::settled(pixels, &point, lines.or_nearer(untracked), noise_q8);
    // Noise breaks the slope of a long blur into parts: it is one edge where it fits as one.
    let others = Neighbours::among(of_row, &point);
    let long = if others == lines { None } else { settled(others) };
    let long = long.filter(|model| model.is_beyond_steps() && model.explains(pixels, point.column_q16, others));
    let model = long.or_else(|| settled(lines));
    if let Some(track) = table.track_mut(place) {
        track.set_model(model, Untracked::of(untracked, point.column_q16));
    }
}
