// How many pixels a 3D view has while it is turned: fewer where a frame takes long, as without a GPU. At rest it is
// drawn sharp.

export const kCoarsest = 0.4; // Of a view's pixels across.
const kSlowMs = 60; // A frame that takes longer stutters.
const kFastMs = 24; // One that takes less has time to spare.
const kStep = 0.75;

// The pixel ratio of the next frame, where the last one was drawn with `ratio` and took `frameMs`.
export function nextRatio(ratio: number, full: number, frameMs: number): number {
  const wanted = frameMs > kSlowMs ? ratio * kStep : frameMs < kFastMs ? ratio / kStep : ratio;
  return Math.min(full, Math.max(Math.min(full, kCoarsest), wanted));
}
