// Which pixels' materials are resolved: every pixel's, those of samples, or those of further
// surfaces at edges.

#ifdef RATED
#export geometry/visibility/rated.wgsl
#endif
#ifdef TILED
#export geometry/visibility/tiled.wgsl
#endif
#ifdef FURTHER
#export antialias/further.wgsl
#endif
#ifdef EVERY
#export geometry/visibility/every.wgsl
#endif
