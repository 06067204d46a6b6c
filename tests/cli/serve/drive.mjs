// Drives the service's page in two browsers that know nothing of each other: what one paints, takes back and hides, the other one must see.
//
//     node drive.mjs http://127.0.0.1:4750/ OUTPUT_FOLDER
//
// Needs playwright-core (PLAYWRIGHT_CORE: where it lies) and Chromium (CHROMIUM, else /usr/bin/chromium). OROGENY_TOKEN: a token, where the service wants one.
// Exit code 0 only if all held. Screenshots go into the folder.

import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

// The library, or where it lies.
const { chromium } = await import(process.env.PLAYWRIGHT_CORE ?? 'playwright-core');

const [url, folder] = process.argv.slice(2);
if (!url || !folder) {
  console.error('usage: node drive.mjs URL OUTPUT_FOLDER');
  process.exit(2);
}
const executablePath = process.env.CHROMIUM ?? '/usr/bin/chromium';
const WAIT_ms = Number(process.env.DRIVE_WAIT_MS ?? 20_000);
// Drawn on the CPU, and nothing asks anything of any other host.
const args = [
  '--headless',
  '--no-sandbox',
  '--disable-gpu',
  '--use-gl=angle',
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];

const problems = [];
const profiles = [];
const contexts = [];
let numHeld = 0;

/** @param {boolean} held @param {string} what */
function expect(held, what) {
  console.log(`${held ? 'held  ' : 'FAILED'}  ${what}`);
  if (held) numHeld += 1;
  else problems.push(what);
}

/** @param {string} name */
async function open(name) {
  const profile = mkdtempSync(join(tmpdir(), 'orogeny-page-'));
  profiles.push(profile);
  const context = await chromium.launchPersistentContext(profile, { executablePath, args, viewport: { width: 1280, height: 800 } });
  contexts.push(context);
  const page = context.pages()[0] ?? (await context.newPage());
  page.on('pageerror', (error) => problems.push(`${name}: ${error.stack ?? error}`));
  page.on('console', (message) => {
    if (message.type() === 'error') problems.push(`${name}: ${message.text()}`);
  });
  page.on('request', (request) => {
    const { protocol, origin } = new URL(request.url());
    if (!['data:', 'blob:'].includes(protocol) && origin !== new URL(url).origin)
      problems.push(`${name}: asked another host: ${request.url()}`);
  });
  await page.goto(url);
  if (process.env.OROGENY_TOKEN) {
    await page.locator('#token').fill(process.env.OROGENY_TOKEN);
    await page.locator('#token').press('Enter');
    // The answer without a token is one, and Chromium tells of it.
    problems.length = 0;
  }
  await page.waitForFunction(() => window.orogeny?.connected && window.orogeny.terrain, null, { timeout: WAIT_ms });
  await page.locator('input[name=view][value=map]').check({ force: true });
  return page;
}

const shot = (page, name) => page.screenshot({ path: join(folder, `${name}.png`) });

/** @param {import('playwright-core').Page} page @param {{x: number, z: number}} at @returns {Promise<number>} once it is known */
const heightAt = async (page, at) =>
  (
    await page.waitForFunction(
      ({ x, z }) => {
        const height_m = window.orogeny.height_m(x, z);
        return height_m === undefined ? null : { height_m };
      },
      at,
      { timeout: WAIT_ms },
    )
  ).evaluate(({ height_m }) => height_m);

/** @param {import('playwright-core').Page} page @param {(now: number) => boolean} holds @param {{x: number, z: number}} at */
async function heightBecomes(page, holds, at) {
  const end = Date.now() + WAIT_ms;
  for (;;) {
    const now = await heightAt(page, at);
    if (holds(now)) return true;
    if (Date.now() > end) return false;
    await page.waitForTimeout(40);
  }
}

/** The same height in a few looks after one another: all that was asked for has come. */
async function settled(page, at) {
  let [before, num_same] = [await heightAt(page, at), 0];
  while (num_same < 8) {
    await page.waitForTimeout(120);
    const now = await heightAt(page, at);
    num_same = Object.is(now, before) ? num_same + 1 : 0;
    before = now;
  }
  return before;
}

/** Middle of the map's canvas, which shows the terrain's middle as long as all is shown. */
async function middleOf(page, canvas) {
  const { x, y, width, height } = await page.locator(canvas).boundingBox();
  return { x: x + width / 2, y: y + height / 2 };
}

/** @param {import('playwright-core').Page} page @param {string} canvas @param {boolean} isLifted */
async function stroke(page, canvas, isLifted = true) {
  const { x, y } = await middleOf(page, canvas);
  await page.mouse.move(x - 60, y - 20);
  await page.mouse.down();
  for (let k = 1; k <= 12; k += 1) {
    await page.mouse.move(x - 60 + 10 * k, y - 20 + (20 * k) / 6 - (k > 6 ? (20 * (k - 6)) / 6 : 0));
    await page.waitForTimeout(15);
  }
  if (isLifted) await page.mouse.up();
}

/** @param {import('playwright-core').Page} page */
const revisionOf = (page) => page.evaluate(() => window.orogeny.revision);

/** @param {import('playwright-core').Page} page @param {(argument: unknown) => boolean} holds in the page @param {unknown} [argument] @returns {Promise<boolean>} */
const comes = (page, holds, argument) =>
  page.waitForFunction(holds, argument, { timeout: WAIT_ms }).then(
    () => true,
    () => false,
  );

/** @param {import('playwright-core').Page} page @param {number} old */
const revisionPasses = (page, old) => comes(page, (before) => window.orogeny.revision > before, old);

/** Whether the lowest layer is shown as visible. */
const isSeen = (page, isVisible) =>
  comes(page, (wanted) => [...document.querySelectorAll('#layers input[type=checkbox]')].at(-1)?.checked === wanted, isVisible);

async function run() {
  mkdirSync(folder, { recursive: true });
  const anna = await open('first');
  const ben = await open('second');
  await anna.locator('#brush-type').selectOption('raise');
  const { width, depth, spacing_m } = await anna.evaluate(() => window.orogeny.terrain);
  const middle = { x: ((width - 1) * spacing_m) / 2, z: ((depth - 1) * spacing_m) / 2 };
  expect(await comes(anna, () => document.querySelectorAll('#people li').length === 2), 'both see that there are two');

  const before_m = await settled(ben, middle);
  const at_first = await revisionOf(ben);
  await shot(ben, 'second-before');

  await stroke(anna, '#map');
  expect(await heightBecomes(ben, (now) => now > before_m + 0.01, middle), 'the second sees what the first painted');
  expect(await heightBecomes(anna, (now) => now > before_m + 0.01, middle), 'and so does the first');
  expect(await revisionPasses(ben, at_first), 'the revision went on');
  const painted_m = await settled(ben, middle);
  await shot(anna, 'first-painted');
  await shot(ben, 'second-painted');

  await anna.keyboard.press('Control+z');
  expect(await heightBecomes(ben, (now) => now === before_m, middle), 'undone: as it was, to the bit');
  await shot(ben, 'second-undone');
  await anna.locator('#redo').click();
  expect(await heightBecomes(ben, (now) => now === painted_m, middle), 'redone: as it was painted, to the bit');
  await anna.locator('#undo').click();
  expect(await heightBecomes(ben, (now) => now === before_m, middle), 'undone again, by the button');

  await stroke(anna, '#map', false);
  expect(await heightBecomes(ben, (now) => now > before_m + 0.01, middle), 'a stroke is seen while it is drawn');
  await shot(ben, 'second-sees-cursor');
  await anna.keyboard.press('Escape');
  await anna.mouse.up();
  expect(await heightBecomes(ben, (now) => now === before_m, middle), 'Esc takes it back');

  await ben.locator('input[name=view][value="3d"]').check({ force: true });
  await ben.waitForTimeout(1500);
  await shot(ben, 'second-3d-before');
  const in_3d_m = await settled(ben, middle);
  await stroke(ben, '#solid');
  expect(await heightBecomes(ben, (now) => now > in_3d_m + 0.01, middle), 'painted in the 3D view');
  expect(await heightBecomes(anna, (now) => now > before_m + 0.01, middle), 'the first sees it on the map');
  await shot(ben, 'second-3d-painted');
  await ben.keyboard.press('Control+z');
  expect(await heightBecomes(anna, (now) => now === before_m, middle), 'undone from there');

  const boxes = anna.locator('#layers input[type=checkbox]');
  const lowest = boxes.last();
  const was = await revisionOf(anna);
  await lowest.click();
  expect(await isSeen(ben, false), 'the second sees that a layer is hidden');
  expect(await revisionPasses(anna, was), 'the revision went on with it');
  await anna.waitForTimeout(800);
  await shot(anna, 'first-layer-hidden');
  await lowest.click();
  expect(await isSeen(ben, true), 'and that it is back');
  expect(await heightBecomes(anna, (now) => now === before_m, middle), 'with its heights');

  await anna.locator('input[name=view][value=both]').check({ force: true });
  await anna.waitForTimeout(1500);
  await shot(anna, 'first-both');
  expect((await anna.locator('.notice[data-kind=error]').allTextContents()).join() === '', 'nothing was complained about');
}

try {
  await run();
} catch (error) {
  problems.push(error.stack ?? String(error));
} finally {
  for (const context of contexts) await context.close().catch(() => {});
  for (const profile of profiles) rmSync(profile, { recursive: true, force: true });
}
for (const problem of problems) console.error(`problem: ${problem}`);
console.log(`${numHeld} held, ${problems.length} problem${problems.length === 1 ? '' : 's'}`);
process.exit(problems.length === 0 ? 0 : 1);
