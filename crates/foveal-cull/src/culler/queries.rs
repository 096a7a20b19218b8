//! Queries about a frame.

use super::Culler;
use crate::bounds::Aabb;
use crate::error::CullError;
use crate::query::choice::OpenObjects;
use crate::query::classify::Query;
use crate::query::flat::Flat;
use crate::query::moving::OccludeeSet;
use crate::query::tree::OccludeeTree;
use crate::query::walk::Walk;
use crate::visibility::Visibility;
use glam::DVec3;

impl Culler {
    /// Classifies boxes against the frame, one result per box in order.
    ///
    /// Boxes are in metres relative to `origin` (world metres). A box that is invalid (NaN,
    /// inside out) is visible. O(boxes): about 5 ns for a random box in a level, up to 100 ns for
    /// one that only single pixels decide. Where most boxes are hidden or outside in groups,
    /// [`query_tree`](Self::query_tree) is faster.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if `results` is not as long as `boxes`.
    pub fn query(
        &self,
        boxes: &[Aabb],
        origin: impl Into<[f64; 3]>,
        results: &mut [Visibility],
    ) -> Result<(), CullError> {
        self.query_from(boxes, DVec3::from(origin.into()), results)
    }

    fn query_from(
        &self,
        boxes: &[Aabb],
        origin: DVec3,
        results: &mut [Visibility],
    ) -> Result<(), CullError> {
        CullError::check_length(boxes.len(), results.len())?;
        let Some(frame) = self.view else {
            results.fill(Visibility::Visible);
            return Ok(());
        };
        let q = Query::new(&self.buffer, &frame, origin);
        self.instruction_set.run(Flat {
            query: &q,
            boxes,
            results,
        });
        Ok(())
    }

    /// Classifies a tree of occludees, one result per object in the order of the boxes it was built
    /// from.
    ///
    /// Results equal those of [`query`](Self::query) on the same boxes, except where a group as a
    /// whole is occluded or outside and the rectangle of one of its objects, which is larger than need
    /// be, is not. Objects of an occluded group are called occluded even if they lie outside the frustum
    /// or are small. Cost grows with the groups that are neither hidden nor outside: 0.06 ms for
    /// 26,894 objects of a market, of which 1,389 are visible.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if `results` is not as long as the tree.
    pub fn query_tree(
        &self,
        tree: &OccludeeTree,
        results: &mut [Visibility],
    ) -> Result<(), CullError> {
        CullError::check_length(tree.len(), results.len())?;
        let Some(frame) = self.view else {
            results.fill(Visibility::Visible);
            return Ok(());
        };
        let query = Query::new(&self.buffer, &frame, tree.origin());
        self.instruction_set.run(Walk {
            query: &query,
            tree,
            results,
        });
        Ok(())
    }

    /// Classifies a set of occludees that move, one result per [`OccludeeId::index`].
    ///
    /// `results` has [`OccludeeSet::result_count`] elements. Results equal those of
    /// [`query`](Self::query) as those of [`query_tree`](Self::query_tree) do.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if `results` has another length.
    ///
    /// [`OccludeeId::index`]: crate::OccludeeId::index
    pub fn query_set(
        &self,
        set: &OccludeeSet,
        results: &mut [Visibility],
    ) -> Result<(), CullError> {
        CullError::check_length(set.result_count(), results.len())?;
        let (Some(frame), Some(tree)) = (self.view, set.tree()) else {
            return self.query_from(set.boxes(), set.origin(), results);
        };
        let query = Query::new(&self.buffer, &frame, set.origin());
        if self.is_list_faster(&query, set, tree) {
            return self.query_from(set.boxes(), set.origin(), results);
        }
        self.instruction_set.run(Walk {
            query: &query,
            tree,
            results,
        });
        // Objects outside the tree, a list at a time.
        const LIST: usize = 128;
        let (mut boxes, mut listed) = ([Aabb::EMPTY; LIST], [Visibility::Visible; LIST]);
        for slots in set.loose().chunks(LIST) {
            for (bounds, &slot) in boxes.iter_mut().zip(slots) {
                *bounds = set.boxes()[slot as usize];
            }
            self.instruction_set.run(Flat {
                query: &query,
                boxes: &boxes[..slots.len()],
                results: &mut listed[..slots.len()],
            });
            for (&slot, result) in slots.iter().zip(listed) {
                results[slot as usize] = result;
            }
        }
        Ok(())
    }

    /// Whether a list of a set's boxes takes less time than its tree in this frame.
    fn is_list_faster(&self, query: &Query<'_>, set: &OccludeeSet, tree: &OccludeeTree) -> bool {
        // With a size threshold a list has no coarse test; without one neither has.
        if query.small > 0.0 || query.coarse_test().is_none() {
            return false;
        }
        // Where nothing is open a tree takes least.
        set.prefers_list(0) || set.prefers_list(self.open_objects(query, tree))
    }

    #[cfg(test)]
    pub(crate) fn open_objects_of(&self, tree: &OccludeeTree) -> usize {
        let frame = self.view.unwrap();
        self.open_objects(&Query::new(&self.buffer, &frame, tree.origin()), tree)
    }

    /// About how many objects of a tree a walk has to open.
    fn open_objects(&self, query: &Query<'_>, tree: &OccludeeTree) -> usize {
        let open = self.instruction_set.run(OpenObjects { query, tree });
        open.unwrap_or(tree.len())
    }

    /// Adds results to the stats of the frame, with the triangles of each occludee if given. Every
    /// result counts; [`count_set`](Self::count_set) is for those of a set.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if there are not as many triangle counts as results. Then
    /// nothing is added.
    pub fn count(
        &mut self,
        results: &[Visibility],
        triangles: Option<&[u32]>,
    ) -> Result<(), CullError> {
        self.count_where(results, triangles, |_| true)
    }

    /// Adds the results of [`query_set`](Self::query_set) to the stats of the frame, with the
    /// triangles by [`OccludeeId::index`](crate::OccludeeId::index) if given. Places that no object
    /// has are left out.
    ///
    /// # Errors
    /// [`CullError::LengthMismatch`] if `results` or `triangles` has not
    /// [`OccludeeSet::result_count`] elements. Then nothing is added.
    pub fn count_set(
        &mut self,
        set: &OccludeeSet,
        results: &[Visibility],
        triangles: Option<&[u32]>,
    ) -> Result<(), CullError> {
        CullError::check_length(set.result_count(), results.len())?;
        self.count_where(results, triangles, |i| set.has_object(i))
    }

    fn count_where(
        &mut self,
        results: &[Visibility],
        triangles: Option<&[u32]>,
        counts: impl Fn(usize) -> bool,
    ) -> Result<(), CullError> {
        if let Some(triangles) = triangles {
            CullError::check_length(results.len(), triangles.len())?;
        }
        let s = &mut self.stats;
        for (i, r) in results.iter().enumerate().filter(|(i, _)| counts(*i)) {
            s.occludees += 1;
            match r {
                Visibility::Visible => s.occludees_visible += 1,
                Visibility::Outside => s.occludees_outside += 1,
                Visibility::Small => s.occludees_small += 1,
                Visibility::Occluded => s.occludees_occluded += 1,
            }
            let t = triangles.map_or(0, |t| u64::from(t[i]));
            s.occludee_triangles += t;
            if r.is_visible() {
                s.occludee_triangles_visible += t;
            }
        }
        Ok(())
    }

    /// The frame, prepared for boxes relative to an origin; none before the first one.
    pub(crate) fn prepared(&self, origin: DVec3) -> Option<Query<'_>> {
        let frame = self.view.as_ref()?;
        Some(Query::new(&self.buffer, frame, origin))
    }
}
