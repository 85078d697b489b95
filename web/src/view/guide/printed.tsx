// The whole guide for paper: parts, then every step with its picture and its crossings. Only there while
// it is printed.

import { useEffect, useRef } from 'preact/hooks';

import { count } from '../../lib/format.ts';
import { t } from '../../messages/messages.ts';
import { crossingRuns, idRanges, type Step } from '../../state/assembly.ts';
import type { JobPackage } from '../../state/package_store.ts';
import { materialName } from '../../state/store.ts';
import type { Palette } from '../model/palette.ts';
import { shotOf } from './step_picture.tsx';
import { stepTitle, stepWords } from './words.ts';

const kPicture = { width: 560, height: 380 };
// Paper is white whatever the screen's scheme is.
const kInk: Palette = {
  weft: '#e0a578', warp: '#86b3c9', surface: '#eeeeee', line: '#777777', ghost: '#777777', mark: '#ffb400', critical: '#111111',
};

function PrintedStep(props: { readonly step: Step; readonly number: number }) {
  const { step, number } = props;
  const { before, after } = stepWords(step);
  return (
    <section class="printed-step">
      <h3>
        {count(number)}. {stepTitle(step)}
      </h3>
      <canvas width={kPicture.width} height={kPicture.height} data-step={number - 1} />
      {before.map((text) => (
        <p key={text}>{text}</p>
      ))}
      {step.kind === 'weave' &&
        step.lays.map((lay) => (
          <p key={lay.strip}>
            {crossingRuns(lay.crossings)
              .map(({ way, strips }) => t.guide.way(t.guide.ways[way], idRanges(strips)))
              .join('; ')}
          </p>
        ))}
      {after.map((text) => (
        <p key={text}>{text}</p>
      ))}
    </section>
  );
}

async function drawPictures(root: HTMLElement, content: JobPackage, steps: readonly Step[]): Promise<void> {
  const { createGuideScene } = await import('../model/guide_scene.ts');
  const canvas = root.querySelector<HTMLCanvasElement>('.printed-source');
  if (canvas === null) return;
  const scene = createGuideScene(canvas, content);
  scene.paint(kInk);
  for (const target of root.querySelectorAll<HTMLCanvasElement>('canvas[data-step]')) {
    const at = Number(target.dataset['step']);
    scene.face(steps[at]?.strips ?? []);
    scene.show(shotOf(steps, at, null));
    scene.copyTo(target);
  }
  scene.dispose();
}

export function PrintedGuide(props: {
  readonly name: string;
  readonly content: JobPackage;
  readonly steps: readonly Step[];
  readonly onDone: () => void;
}) {
  const { name, content, steps, onDone } = props;
  const root = useRef<HTMLDivElement>(null);
  useEffect(() => {
    let gone = false;
    const element = root.current;
    if (element === null) return undefined;
    // Without 3D the words are printed alone.
    void drawPictures(element, content, steps)
      .catch((fault: unknown) => console.warn('no pictures', fault))
      .then(() => {
        if (gone) return;
        print();
        onDone();
      });
    return () => {
      gone = true;
    };
  }, []);
  return (
    <div class="printed" ref={root} aria-hidden="true">
      <canvas class="printed-source" />
      <h1>{name}</h1>
      <h2>{t.guide.parts}</h2>
      {content.sheets.map((sheet) => (
        <p key={sheet.id}>
          <strong>{t.guide.sheet(count(sheet.id), materialName(sheet.material))}:</strong>{' '}
          {sheet.pieces.map(({ piece }) => piece).join(', ')}
        </p>
      ))}
      <h2>{t.guide.all}</h2>
      {steps.map((step, index) => (
        <PrintedStep key={index} step={step} number={index + 1} />
      ))}
    </div>
  );
}
