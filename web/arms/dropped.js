// @ts-check
/** Files that are dropped or picked, with their paths where a whole folder is. */

/** @typedef {{path: string, file: File}} Sent */

const OF_AN_ARM = /\.(urdf|xacro|zip)$/i;

/**
 * @param {DataTransfer} transfer
 * @returns {boolean} whether it may be an arm: a folder, a URDF or a ZIP
 */
export function mayBeArm(transfer) {
  return [...transfer.items].some((item) => {
    const entry = item.webkitGetAsEntry?.();
    return entry?.isDirectory || OF_AN_ARM.test(entry?.name ?? item.getAsFile()?.name ?? '');
  });
}

/**
 * The entries are asked for at once: they are gone when the drop is over.
 *
 * @param {DataTransfer} transfer
 * @returns {Promise<Sent[]>} all files, those of folders too
 */
export async function droppedFiles(transfer) {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry?.() ?? null);
  const plain = [...transfer.files];
  if (!entries.some(Boolean)) return plain.map((file) => ({path: file.name, file}));
  const found = await Promise.all(entries.map((entry) => (entry ? within(entry) : [])));
  return found.flat();
}

/**
 * @param {FileList|null} files
 * @returns {Sent[]}
 */
export function pickedFiles(files) {
  return [...files ?? []].map((file) => ({path: file.webkitRelativePath || file.name, file}));
}

/**
 * @param {FileSystemEntry} entry
 * @returns {Promise<Sent[]>}
 */
async function within(entry) {
  if (entry.isFile) {
    const one = /** @type {FileSystemFileEntry} */ (entry);
    /** @type {File} */
    const file = await new Promise((done, failed) => { one.file(done, failed); });
    return [{path: entry.fullPath.replace(/^\//, ''), file}];
  }
  const reader = /** @type {FileSystemDirectoryEntry} */ (entry).createReader();
  const found = [];
  for (;;) {
    /** @type {FileSystemEntry[]} */
    const some = await new Promise((done, failed) => { reader.readEntries(done, failed); });
    if (!some.length) break;  // it tells a hundred at a time
    found.push(...some);
  }
  return (await Promise.all(found.map(within))).flat();
}
