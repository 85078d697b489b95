// What a step says, in the reader's language.

import type { JointMove } from '../../api/assembly_file.ts';
import { t } from '../../messages/messages.ts';
import { idRanges, type Step } from '../../state/assembly.ts';

export function stepTitle(step: Step): string {
  const { titles } = t.guide;
  const ids = idRanges(step.strips);
  const [lay] = step.lays;
  if (step.kind === 'table') return titles.table(ids);
  if (step.kind === 'base') return step.strips.length === 1 ? titles.baseOne(ids) : titles.base(ids);
  if (step.kind === 'joints') return titles.joints(ids);
  return lay?.kind === 'thread' ? titles.thread(ids) : titles.weave(ids);
}

function jointText(joint: JointMove): string {
  const { texts } = t.guide;
  const what =
    joint.kind === 'close'
      ? texts.close(joint.piece)
      : joint.onto === ''
        ? texts.joinMany(joint.piece)
        : texts.join(joint.piece, joint.onto);
  return joint.tucked > 0 ? `${what} ${texts.tucked(joint.tucked)}` : what;
}

export interface StepWords {
  readonly before: readonly string[];
  readonly after: readonly string[]; // What is done once the crossings are made.
}

export function stepWords(step: Step): StepWords {
  const { texts } = t.guide;
  if (step.kind === 'table') return { before: [texts.table], after: step.joints.map(jointText) };
  if (step.kind === 'base') return { before: [step.strips.length === 1 ? texts.baseOne : texts.base], after: [] };
  if (step.kind === 'joints') return { before: [], after: step.joints.map(jointText) };
  const threaded = step.lays.flatMap((lay) => lay.crossings.filter((one) => one.way === 'threaded').map((one) => one.strip));
  const thread = threaded.length > 0 ? [texts.thread(idRanges(threaded))] : [];
  return { before: [...thread, texts.weave], after: step.joints.map(jointText) };
}
