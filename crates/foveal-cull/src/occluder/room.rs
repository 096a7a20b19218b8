//! How the lists of a mesh grow.

/// Room for further elements; where there is none, for an eighth more than there are, since a large
/// mesh with twice the room that it needs is what baking takes most memory for.
pub(super) fn make_room<T>(list: &mut Vec<T>, further: usize) {
    if list.capacity() - list.len() < further {
        list.reserve_exact(further.max(list.len() / 8));
    }
}
