import { defineConfig } from '@playwright/test';
import { mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';

const PORT = 7199;
const program = process.env.MYO_PROGRAM ?? resolve('../../target/debug/myo');
/** A folder of its own for every run; workers of the same run find it by name. */
const folder = (process.env.MYO_STUDIO_FOLDER ??= mkdtempSync(join(tmpdir(), 'myo-studio-')));

export default defineConfig({
  testDir: 'tests',
  // Two cores, and a training wants both.
  workers: 1,
  timeout: 2_000_000,
  expect: { timeout: 30_000 },
  reporter: [['line']],
  use: {
    baseURL: `http://127.0.0.1:${PORT}`,
    viewport: { width: 1280, height: 720 },
    launchOptions: {
      executablePath: process.env.MYO_BROWSER ?? '/usr/bin/chromium',
      args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
    },
    screenshot: 'only-on-failure',
  },
  webServer: {
    command: `${program} studio --no-open --port ${PORT} --folder ${folder} --backend cpu`,
    url: `http://127.0.0.1:${PORT}/`,
    stdout: 'pipe',
  },
});
